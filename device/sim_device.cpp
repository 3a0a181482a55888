#include "device/sim_device.h"

#include <cmath>

#include "device/scales.h"

namespace handloop::device {
namespace {

static_assert(sim::kMotors == kMaxMotors && sim::kAnalogInputs == kMaxAnalogInputs);

}  // namespace

models::Scenario plant_scenario(models::Scenario scenario) {
  scenario.loop.delay_samples = 0;
  return scenario;
}

DeviceDescription describe(const sim::PlantDescription& plant, const models::Scenario& scenario) {
  DeviceDescription d;
  d.motor_count = sim::kMotors;
  d.analog_input_count = sim::kAnalogInputsUsed;
  d.encoder_rad_per_count = plant.encoder_rad_per_count;
  d.encoder_zero_rad = plant.encoder_zero_rad;
  d.transmission_ratio = plant.transmission_ratio;
  d.torque_Nm_per_A = plant.torque_Nm_per_A;
  d.amplifier_A_per_V = plant.amplifier_A_per_V;
  d.current_limit_A = plant.current_limit_A;
  d.dac_bits = plant.dac_bits;
  d.dac_range_V = plant.dac_range_V;
  d.adc_bits = plant.adc_bits;
  d.adc_range_V = plant.adc_range_V;
  d.analog_N_per_V = plant.analog_N_per_V;
  d.sample_time_s = plant.sample_time_s;
  d.ideal = scenario.electronics.ideal;
  return d;
}

Reading to_reading(const sim::PlantReading& from, double sample_time_s) {
  Reading reading;
  reading.sample = from.sample;
  reading.time_ns = std::llround(static_cast<double>(from.sample) * sample_time_s * 1e9);
  reading.encoder_counts = from.encoder_counts;
  reading.adc_codes = from.adc_codes;
  reading.valid = true;
  return reading;
}

SimDevice::SimDevice(const models::Scenario& scenario, const sim::PlantOptions& options)
    : plant_(plant_scenario(scenario), options), description_(describe(plant_.description(), scenario)) {}

void SimDevice::start() {
  plant_.reset();
  stopped_ = false;
}

Reading SimDevice::read() {
  return to_reading(plant_.read(), description_.sample_time_s);
}

bool SimDevice::write(const Command& command) {
  sim::PlantCommand to_plant;
  to_plant.dac_codes = command.dac_codes;
  if (stopped_) to_plant.dac_codes.fill(zero_code(description_));
  if (sim::Pull pull; pulls_.take(pull)) plant_.set_pull(pull);
  plant_.advance(to_plant);
  return true;
}

void SimDevice::stop() {
  stopped_ = true;
}

}  // namespace handloop::device
