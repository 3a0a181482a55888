#pragma once

#include "device/device.h"
#include "device/mailbox.h"
#include "sim/phantom_plant.h"

namespace handloop::device {

/// The simulated plant as a device: lock-step, virtual time, one plant sample for each write. read() is repeatable
/// until write() moves on.
class SimDevice final : public Device {
 public:
  /// The plant is that of the scenario without its loop delay, which the loop itself carries out.
  /// Throws InputError where the scenario cannot be simulated.
  explicit SimDevice(const models::Scenario& scenario, const sim::PlantOptions& options = {});

  std::string_view name() const override { return "sim"; }
  const DeviceDescription& description() const override { return description_; }
  void start() override;
  Reading read() override;
  bool write(const Command& command) override;
  void stop() override;
  bool lock_step() const override { return true; }

  /// Pulls at the stylus from the next sample on. From one thread, which may be another than that of read() and
  /// write(); neither waits.
  void pull(const sim::Pull& pull) { pulls_.post(pull); }

  /// What really happens in there: for tests, panels and demonstrations, never for a controller.
  sim::PhantomPlant& plant() { return plant_; }
  const sim::PhantomPlant& plant() const { return plant_; }

 private:
  sim::PhantomPlant plant_;
  DeviceDescription description_;
  Mailbox<sim::Pull> pulls_;
  bool stopped_ = false;
};

/// Description of a simulated plant, without making one into a device.
DeviceDescription describe(const sim::PlantDescription& plant, const models::Scenario& scenario);

/// Reading `reading` of a plant in device terms, at virtual time sample * T.
Reading to_reading(const sim::PlantReading& reading, double sample_time_s);

/// The scenario as the plant must see it: without the loop's delay.
models::Scenario plant_scenario(models::Scenario scenario);

}  // namespace handloop::device
