#include "sim/electronics.h"

#include <cmath>
#include <string>

#include "models/errors.h"

namespace handloop::sim {
namespace {

using models::RandomStream;

/// Of the pinch sensor's conditioned output: an assumption, 10 V at 10 N.
constexpr double kGrip_N_per_V = 1.0;

void require_positive(const char* key, double value) {
  if (!(value > 0) || !std::isfinite(value)) {
    throw InputError(std::string("electronics.") + key + " = " + std::to_string(value) +
                     " is not possible: it must be above zero");
  }
}

void require_bits(const char* key, int bits) {
  if (bits < 2 || bits > 30) {
    throw InputError(std::string("electronics.") + key + " = " + std::to_string(bits) + " is not possible: 2 to 30");
  }
}

}  // namespace

models::ElectronicsSettings effective(const models::ElectronicsSettings& settings) {
  if (!settings.ideal) return settings;
  auto ideal = settings;
  ideal.encoder_counts_per_rev = 1 << 28;
  ideal.dac_bits = ideal.adc_bits = 30;
  ideal.dac_range_V = ideal.adc_range_V = 100.0;
  ideal.current_limit_A = 1000.0;
  ideal.force_noise_N = ideal.grip_noise_N = 0.0;
  return ideal;
}

Electronics::Electronics(const models::Scenario& scenario)
    : settings_(effective(scenario.electronics)),
      sample_time_s_(scenario.loop.sample_time_s),
      drive_(models::phantom_drive()),
      encoder_{settings_.encoder_counts_per_rev},
      dac_{settings_.dac_bits, settings_.dac_range_V},
      adc_{settings_.adc_bits, settings_.adc_range_V},
      amplifier_{settings_.amplifier_A_per_V, settings_.current_limit_A},
      force_noise_{models::CounterRandom(scenario.run.seed, RandomStream::sensor_noise, 0),
                   models::CounterRandom(scenario.run.seed, RandomStream::sensor_noise, 1),
                   models::CounterRandom(scenario.run.seed, RandomStream::sensor_noise, 2)},
      grip_noise_(scenario.run.seed, RandomStream::grip_noise) {
  require_bits("dac_bits", settings_.dac_bits);
  require_bits("adc_bits", settings_.adc_bits);
  require_positive("encoder_counts_per_rev", settings_.encoder_counts_per_rev);
  require_positive("dac_range_V", settings_.dac_range_V);
  require_positive("adc_range_V", settings_.adc_range_V);
  require_positive("amplifier_A_per_V", settings_.amplifier_A_per_V);
  require_positive("current_limit_A", settings_.current_limit_A);
  require_positive("force_sensor_N_per_V", settings_.force_sensor_N_per_V);
  require_positive("grip_rate_Hz", settings_.grip_rate_Hz);
}

void describe_converters(const models::ElectronicsSettings& settings, PlantDescription& description) {
  description.amplifier_A_per_V = settings.amplifier_A_per_V;
  description.current_limit_A = settings.current_limit_A;
  description.dac_bits = settings.dac_bits;
  description.dac_range_V = settings.dac_range_V;
  description.adc_bits = settings.adc_bits;
  description.adc_range_V = settings.adc_range_V;
}

PlantDescription Electronics::describe() const {
  PlantDescription description;
  for (std::size_t i = 0; i < kMotors; ++i) {
    description.encoder_rad_per_count[i] = encoder_.resolution_rad();
    description.transmission_ratio[i] = drive_.ratio[i];
    description.torque_Nm_per_A[i] = drive_.motor.torque_constant_Nm_per_A;
    description.analog_N_per_V[i] = settings_.force_sensor_N_per_V;
  }
  description.analog_N_per_V[3] = kGrip_N_per_V;
  describe_converters(settings_, description);
  description.sample_time_s = sample_time_s_;
  return description;
}

std::array<double, kMotors> Electronics::currents_A(const PlantCommand& command) const {
  std::array<double, kMotors> current;
  for (std::size_t i = 0; i < kMotors; ++i) current[i] = amplifier_.current_A(dac_.volt(command.dac_codes[i]));
  return current;
}

double Electronics::joint_torque_Nm(std::size_t motor, double current_A) const {
  return drive_.joint_torque_Nm(static_cast<int>(motor), current_A);
}

std::int32_t Electronics::encoder_counts(std::size_t motor, double joint_rad) const {
  return encoder_.counts(joint_rad * drive_.ratio[motor] + 0.5 * encoder_.resolution_rad());
}

std::array<std::uint32_t, kAnalogInputs> Electronics::adc_codes(std::uint64_t sample,
                                                                const std::array<double, 3>& force_N,
                                                                double grip_N) const {
  std::array<std::uint32_t, kAnalogInputs> codes;
  codes.fill(adc_.code(0.0));
  for (std::size_t i = 0; i < 3; ++i) {
    const double noise = settings_.force_noise_N > 0 ? settings_.force_noise_N * force_noise_[i].normal(sample) : 0.0;
    codes[i] = adc_.code((force_N[i] + noise) / settings_.force_sensor_N_per_V);
  }
  // its own clock: the last value it sent, whatever the loop's rate
  const auto sent =
      static_cast<std::uint64_t>(static_cast<double>(sample) * sample_time_s_ * settings_.grip_rate_Hz + 1e-9);
  const double noise = settings_.grip_noise_N > 0 ? settings_.grip_noise_N * grip_noise_.normal(sent) : 0.0;
  codes[3] = adc_.code((grip_N + noise) / kGrip_N_per_V);
  return codes;
}

}  // namespace handloop::sim
