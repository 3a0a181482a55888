#pragma once

#include <array>
#include <cstdint>

#include "models/random.h"
#include "models/scenario.h"
#include "models/transducers.h"
#include "sim/phantom_plant.h"

namespace handloop::sim {

/// The settings a plant works with: the scenario's, or where they are ideal, converters and encoders so fine that
/// nothing is lost, limits out of reach and no noise.
models::ElectronicsSettings effective(const models::ElectronicsSettings& settings);

/// Amplifier and converters of the settings, as whoever speaks to the device must know them.
void describe_converters(const models::ElectronicsSettings& settings, PlantDescription& description);

/// Converters, amplifier, encoders, force sensor and grip sensor of the simulated device. Noise is a function of seed,
/// channel and sample number. Real-time safe after construction.
class Electronics {
 public:
  /// Throws InputError where a setting is impossible.
  explicit Electronics(const models::Scenario& scenario);

  /// Scales for whoever speaks to the device; encoder_zero_rad and physics_step_s are the plant's to fill in.
  PlantDescription describe() const;
  /// Motor currents the DAC codes ask for, after the limit.
  std::array<double, kMotors> currents_A(const PlantCommand& command) const;
  /// Torque at the joint.
  double joint_torque_Nm(std::size_t motor, double current_A) const;
  /// Counts of the motor's encoder where the joint stands this far from where it was at count 0 (the middle of a
  /// count).
  std::int32_t encoder_counts(std::size_t motor, double joint_rad) const;
  /// Codes of the force (device frame) with noise, and of the pinch as its slow sensor last saw it.
  std::array<std::uint32_t, kAnalogInputs> adc_codes(std::uint64_t sample, const std::array<double, 3>& force_N,
                                                     double grip_N) const;

 private:
  models::ElectronicsSettings settings_;
  double sample_time_s_;
  models::PhantomDrive drive_;
  models::Encoder encoder_;
  models::Converter dac_, adc_;
  models::Amplifier amplifier_;
  std::array<models::CounterRandom, 3> force_noise_;
  models::CounterRandom grip_noise_;
};

}  // namespace handloop::sim
