#include "device/seven_bar_device.h"

#include "device/scales.h"
#include "device/sim_device.h"

namespace handloop::device {
namespace {

DeviceDescription describe_linkage(const sim::PlantDescription& plant, const models::Scenario& scenario) {
  DeviceDescription d = describe(plant, scenario);
  d.motor_count = sim::kSevenBarMotors;
  d.analog_input_count = sim::kSevenBarAnalogInputs;
  // Channels along and across link 6; the mechanism turns them into the device frame.
  d.gauge_count = 4;
  d.gauge_N_per_V[0][0] = d.gauge_N_per_V[2][1] = plant.analog_N_per_V[0];
  d.environment_N_per_V[0][2] = d.environment_N_per_V[2][3] = plant.analog_N_per_V[2];
  return d;
}

}  // namespace

SevenBarDevice::SevenBarDevice(const models::Scenario& scenario, const sim::PlantOptions& options)
    : plant_(plant_scenario(scenario), options), description_(describe_linkage(plant_.description(), scenario)) {}

void SevenBarDevice::start() {
  plant_.reset();
  stopped_ = false;
}

Reading SevenBarDevice::read() {
  return to_reading(plant_.read(), description_.sample_time_s);
}

bool SevenBarDevice::write(const Command& command) {
  sim::PlantCommand to_plant;
  to_plant.dac_codes = command.dac_codes;
  if (stopped_) to_plant.dac_codes.fill(zero_code(description_));
  plant_.advance(to_plant);
  return true;
}

std::unique_ptr<Device> make_simulated_device(const models::Scenario& scenario) {
  if (scenario.device.model == models::DeviceModel::seven_bar) return std::make_unique<SevenBarDevice>(scenario);
  return std::make_unique<SimDevice>(scenario);
}

}  // namespace handloop::device
