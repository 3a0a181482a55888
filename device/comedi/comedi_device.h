#pragma once

#include <memory>

#include "device/comedi/boards.h"
#include "device/comedi/guardian.h"
#include "device/device.h"
#include "device/timing.h"

namespace handloop::device::comedi {

/// Real boards through Comedi. Keeps wall-clock time: the session is paced by the caller's clock, and sample numbers
/// tell how many periods have passed since the last read. The DACs are at zero from construction on, after stop(), and,
/// by the guardian process, after this process ended in any way or stood still for longer than the watchdog.
class ComediDevice final : public Device {
 public:
  /// The counters are taken to stand at the scenario's pose when start() is called.
  /// Throws InputError naming board, subdevice and what is wrong.
  ComediDevice(const ComediConfig& config, const std::array<double, 3>& pose_rad, double sample_time_s);
  ~ComediDevice() override;

  std::string_view name() const override { return "comedi"; }
  const DeviceDescription& description() const override { return description_; }
  void start() override;
  Reading read() override;
  bool write(const Command& command) override;
  void stop() override;
  bool lock_step() const override { return false; }

  /// What drivers refused without harm.
  const std::vector<std::string>& tolerated() const { return encoders_.tolerated(); }
  std::uint64_t guardian_interventions() const { return guardian_ ? guardian_->interventions() : 0; }
  pid_t guardian_process() const { return guardian_ ? guardian_->process() : -1; }

 private:
  ComediConfig config_;
  EncoderCounters encoders_;
  MotorOutputs motors_;
  ForceInputs force_;
  DeviceDescription description_;
  std::unique_ptr<Guardian> guardian_;
  MonotonicClock clock_;
  std::int64_t origin_ns_ = 0, begin_ns_ = 0;
  std::uint64_t next_sample_ = 0;
};

}  // namespace handloop::device::comedi
