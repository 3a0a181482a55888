#pragma once

#include <atomic>
#include <cstdint>

#include "device/black_box.h"
#include "device/latency.h"
#include "device/loop.h"
#include "device/recorder.h"
#include "device/timing.h"

/// A loop run from start to end on a device.
namespace handloop::device {

struct SessionOptions {
  std::uint64_t steps = 5000;
  /// Paced by the clock; without it a lock-step device runs as fast as it can. Devices that are not lock-step are
  /// always paced.
  bool paced = false;
  /// Set from outside (signal handler, panel) to end the session early; may be null.
  const std::atomic<bool>* stop = nullptr;
  /// How long the session goes on after a fault, so that the ramp and what followed are recorded.
  double after_fault_s = 0.1;
};

struct SessionResult {
  std::uint64_t steps = 0;
  FaultEvent fault;
  bool stopped_early = false;  ///< by SessionOptions::stop
  Schedule timing;             ///< where paced
  LatencyHistogram compute;    ///< one pass without the device's own time
  LatencyHistogram wake;       ///< lateness of wake-ups, where paced
  double wall_time_s = 0.0;
  std::uint64_t missing_samples = 0, stale_samples = 0, clipped_samples = 0;
};

/// Starts the device, runs the loop, and stops the device on every way out, exceptions included.
/// A recorder that fails trips the loop: the force ramps to zero and the session ends. Throws what Device::start()
/// throws.
SessionResult run_session(Device& device, Loop& loop, Recorder& recorder, BlackBox& black_box, Clock& clock,
                          const SessionOptions& options);

}  // namespace handloop::device
