#include "device/session.h"

#include <chrono>
#include <cmath>

namespace handloop::device {
namespace {

/// Zeroes the device however the scope is left.
class StopGuard {
 public:
  explicit StopGuard(Device& device) : device_(device) {}
  ~StopGuard() {
    try {
      device_.stop();
    } catch (...) {
      // A device that cannot even be stopped has nothing more to be asked.
    }
  }
  StopGuard(const StopGuard&) = delete;
  StopGuard& operator=(const StopGuard&) = delete;

 private:
  Device& device_;
};

}  // namespace

SessionResult run_session(Device& device, Loop& loop, Recorder& recorder, BlackBox& black_box, Clock& clock,
                          const SessionOptions& options) {
  SessionResult result;
  const double sample_time_s = device.description().sample_time_s;
  const bool paced = options.paced || !device.lock_step();
  const auto steps_after_fault = static_cast<std::uint64_t>(std::lround(options.after_fault_s / sample_time_s));

  StopGuard guard(device);
  device.start();
  const auto begin = std::chrono::steady_clock::now();
  result.timing = begin_schedule(clock.now_ns(), std::llround(sample_time_s * 1e9));

  std::uint64_t left_after_fault = steps_after_fault;
  while (result.steps < options.steps) {
    if (options.stop != nullptr && options.stop->load(std::memory_order_relaxed)) {
      result.stopped_early = true;
      break;
    }
    if (paced) {
      const WakeUp wake = wait_for_next_cycle(result.timing, clock);
      result.wake.add(wake.late_ns);
    }
    const StepRecord& record = loop.step(device);
    result.compute.add(record.compute_ns);
    black_box.add(record);
    ++result.steps;
    if (!recorder.take(record)) loop.trip(Fault::log_failed);
    if (record.fault != Fault::none && left_after_fault-- == 0) break;
  }
  result.wall_time_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  result.fault = loop.fault();
  result.missing_samples = loop.missing_samples();
  result.stale_samples = loop.stale_samples();
  result.clipped_samples = loop.clipped_samples();
  return result;
}

}  // namespace handloop::device
