#pragma once

#include <array>
#include <atomic>

#include "control/controllers/controller.h"
#include "control/controllers/mechanism.h"
#include "device/device.h"
#include "device/encoder_watch.h"
#include "device/fault.h"
#include "device/record.h"
#include "device/safety.h"
#include "device/scales.h"
#include "device/state_monitor.h"

namespace handloop::device {

inline constexpr int kMaxDelaySamples = 64;

struct LoopConfig {
  SafetyLimits limits;
  /// What is computed from the reading of sample n is written in sample n + delay_samples.
  int delay_samples = 1;
  StateLimits states;
};

/// The haptic loop, one sample a call: read, check finite, convert, control, limit, envelope, delay, write.
///
/// Delay. Reading n is taken at t_n and the force computed from it acts from t_(n+d) + c, until the next write, where d
/// is `delay_samples` and c the time one pass takes (zero in lock-step, microseconds on hardware). With d = 0 that is
/// read, compute, write; with d >= 1 finished commands wait d samples in a line inside the loop. The plant P held by a
/// zero-order hold therefore sees C(z) z^-d, the loop the margins are computed for, on every device. A fault does not
/// wait in line.
///
/// Missing samples. A reading that is not valid, or not newer than the last, is counted and the last force held. Where
/// a gap ends, the controller is given the missing samples by linear interpolation, so that its filter stays in step.
/// Longer gaps than the watchdog allows are a fault.
///
/// Faults. The first is latched and the force ends, at once or by a ramp of the DAC codes (fault_info). From then on
/// the loop goes on reading and writes the zero code, until reset().
///
/// step() is real-time safe: it does not allocate, lock, format or throw, whatever device and controller do.
class Loop {
 public:
  /// All three must outlive the loop. Throws InputError where the delay is out of range or the sample times differ.
  Loop(const LoopConfig& config, const DeviceDescription& description, const control::Mechanism& mechanism,
       control::Controller& controller);

  /// Unlatches the fault and forgets the past: as new.
  void reset() noexcept;

  /// One sample. The reference is valid until the next call.
  const StepRecord& step(Device& device) noexcept;

  /// Latches a fault found outside (log, timing). Takes effect in the next step; safe from any thread.
  void trip(Fault fault) noexcept { requested_.store(fault, std::memory_order_relaxed); }

  const FaultEvent& fault() const noexcept { return event_; }
  /// Readings that were not there, and that came out of order.
  std::uint64_t missing_samples() const noexcept { return missing_; }
  std::uint64_t stale_samples() const noexcept { return stale_; }
  std::uint64_t clipped_samples() const noexcept { return clipped_; }

 private:
  struct Pending {
    std::array<std::uint32_t, kMaxMotors> codes{};
    Eigen::Vector3d force_N = Eigen::Vector3d::Zero();
    bool in_contact = false;
  };

  void compute(const Reading& reading) noexcept;
  void take(const Reading& reading);
  bool take_fresh(const Reading& reading, std::uint64_t samples);
  FaultEvent check_states(const control::ControllerInput& input, std::uint64_t samples) noexcept;
  void latch(FaultEvent event) noexcept;
  FaultEvent check_encoders(const control::ControllerInput& input, std::uint64_t samples) noexcept;
  Command next_command() noexcept;
  void write(Device& device) noexcept;

  LoopConfig config_;
  DeviceDescription description_;
  const control::Mechanism& mechanism_;
  control::Controller& controller_;
  Eigen::Vector3d feedforward_bound_Nm_;
  std::uint32_t zero_;

  ForceLimiter limiter_;
  PassivityObserver observer_;
  MotionMonitor monitor_;
  EncoderWatch encoders_;
  bool forces_known_;  ///< commands cause the motion, and a sensor tells the force passed on
  StateMonitor state_monitor_;
  EncoderUnwrap unwrap_;

  StepRecord record_;
  FaultEvent event_;
  std::atomic<Fault> requested_{Fault::none};
  std::uint64_t steps_ = 0;
  bool started_ = false;
  std::uint64_t last_sample_ = 0;
  std::int64_t last_fresh_ns_ = 0;
  int samples_without_reading_ = 0;
  int failed_writes_ = 0;
  double missing_share_ = 0.0, failed_share_ = 0.0;  ///< of late, forgetting with a time constant of 0.5 s
  std::uint64_t missing_ = 0, stale_ = 0, clipped_ = 0;

  std::array<Pending, kMaxDelaySamples + 1> line_;  ///< ring: commands waiting for their sample
  std::size_t head_ = 0;
  Pending computed_;  ///< of this pass
  Pending held_;      ///< written last
  std::array<std::uint32_t, kMaxMotors> ramp_from_{};
  int ramp_step_ = 0, ramp_steps_ = 0;
};

}  // namespace handloop::device
