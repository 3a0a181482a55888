#pragma once

#include <filesystem>
#include <vector>

#include "device/device.h"
#include "device/scales.h"
#include "models/scenario.h"

namespace handloop::device {

/// A recording in the place of a device: what was read then is read again; what is written goes nowhere. Lock-step.
/// A log of `handloop run` gives its own counts and codes back, so the same controller writes the same log again. Any
/// other recording (time, force, position of one axis) is turned into counts and codes as the scenario's device would
/// have given them, with the tip moving along the wall's axis.
class ReplayDevice final : public Device {
 public:
  /// Throws InputError naming the file where it cannot be used: see io::read_recording, or a position out of reach.
  ReplayDevice(const DeviceDescription& description, const models::Scenario& scenario,
               const std::filesystem::path& recording);

  std::string_view name() const override { return "replay"; }
  const DeviceDescription& description() const override { return description_; }
  void start() override;
  /// After the last sample: valid = false.
  Reading read() override;
  bool write(const Command& command) override;
  void stop() override {}
  bool lock_step() const override { return true; }

  std::uint64_t samples() const { return readings_.size(); }
  /// Commands that differ from those in the log, where there were any.
  std::uint64_t different_commands() const { return different_; }
  bool has_commands() const { return !commands_.empty(); }

 private:
  bool read_log(const std::filesystem::path& path);
  void read_recording(const std::filesystem::path& path, const models::Scenario& scenario);

  DeviceDescription description_;
  std::vector<Reading> readings_;
  std::vector<Command> commands_;
  std::size_t next_ = 0;
  std::uint64_t different_ = 0;
};

}  // namespace handloop::device
