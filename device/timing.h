#pragma once

#include <cstdint>

/// When the loop runs. Policies are plain functions of a clock that is handed in, so that stalls and clock steps are
/// tested without a wall clock. Real-time safe.
namespace handloop::device {

/// A clock and a way to sleep. Times in ns since any fixed moment.
class Clock {
 public:
  virtual ~Clock() = default;
  virtual std::int64_t now_ns() noexcept = 0;
  /// Returns at `wake_ns` or later; at once where that is past. May return early on a signal.
  virtual void sleep_until(std::int64_t wake_ns) noexcept = 0;
};

/// CLOCK_MONOTONIC with absolute sleeps (clock_nanosleep, TIMER_ABSTIME).
class MonotonicClock final : public Clock {
 public:
  std::int64_t now_ns() noexcept override;
  void sleep_until(std::int64_t wake_ns) noexcept override;
};

/// A periodic schedule: wake-ups at start_ns + k period_ns, k = 0, 1, ...
struct Schedule {
  std::int64_t start_ns = 0;
  std::int64_t period_ns = 1'000'000;
  std::int64_t next_cycle = 0;     ///< k of the next wake-up
  std::uint64_t missed = 0;        ///< deadlines passed without a wake-up, all together
  std::uint64_t longest_miss = 0;  ///< most in a row
  std::uint64_t clock_steps = 0;   ///< the clock went back: the schedule was begun anew
  std::int64_t last_now_ns = 0;
};

/// What one wake-up turned out to be.
struct WakeUp {
  std::int64_t cycle = 0;  ///< k of this wake-up
  std::int64_t due_ns = 0;
  std::int64_t late_ns = 0;   ///< of this wake-up against due_ns
  std::uint64_t skipped = 0;  ///< cycles that were missed just before it
};

Schedule begin_schedule(std::int64_t now_ns, std::int64_t period_ns) noexcept;

/// Books that it is `now_ns` and the next cycle is to run. Cycles whose whole period is past are skipped and counted;
/// the phase is kept: later wake-ups are still at start + k period. A clock that went back by more than a period begins
/// the schedule anew from there.
WakeUp account_wake_up(Schedule& schedule, std::int64_t now_ns) noexcept;

/// Sleeps until the next cycle is due (again after early returns), then books it.
WakeUp wait_for_next_cycle(Schedule& schedule, Clock& clock) noexcept;

}  // namespace handloop::device
