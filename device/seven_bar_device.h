#pragma once

#include <memory>

#include "device/device.h"
#include "sim/seven_bar_plant.h"

namespace handloop::device {

/// The simulated seven-bar linkage as a device: lock-step, virtual time, one plant sample for each write.
class SevenBarDevice final : public Device {
 public:
  /// Throws InputError where the scenario cannot be simulated.
  explicit SevenBarDevice(const models::Scenario& scenario, const sim::PlantOptions& options = {});

  std::string_view name() const override { return "sim"; }
  const DeviceDescription& description() const override { return description_; }
  void start() override;
  Reading read() override;
  bool write(const Command& command) override;
  void stop() override { stopped_ = true; }
  bool lock_step() const override { return true; }

  /// What really happens in there: for tests and studies, never for a controller.
  sim::SevenBarPlant& plant() { return plant_; }
  const sim::SevenBarPlant& plant() const { return plant_; }

 private:
  sim::SevenBarPlant plant_;
  DeviceDescription description_;
  bool stopped_ = false;
};

/// Simulated device of a scenario, whichever it is. Throws InputError.
std::unique_ptr<Device> make_simulated_device(const models::Scenario& scenario);

}  // namespace handloop::device
