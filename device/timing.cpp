#include "device/timing.h"

#include <time.h>

#include <algorithm>

namespace handloop::device {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;

}  // namespace

std::int64_t MonotonicClock::now_ns() noexcept {
  timespec t{};
  clock_gettime(CLOCK_MONOTONIC, &t);
  return t.tv_sec * kSecond_ns + t.tv_nsec;
}

void MonotonicClock::sleep_until(std::int64_t wake_ns) noexcept {
  timespec t{};
  t.tv_sec = wake_ns / kSecond_ns;
  t.tv_nsec = wake_ns % kSecond_ns;
  clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &t, nullptr);
}

Schedule begin_schedule(std::int64_t now_ns, std::int64_t period_ns) noexcept {
  Schedule schedule;
  schedule.start_ns = now_ns;
  schedule.last_now_ns = now_ns;
  schedule.period_ns = std::max<std::int64_t>(period_ns, 1);
  return schedule;
}

WakeUp account_wake_up(Schedule& schedule, std::int64_t now_ns) noexcept {
  WakeUp wake;
  const bool went_back = now_ns < schedule.last_now_ns - schedule.period_ns;
  schedule.last_now_ns = now_ns;
  if (went_back) {
    // Cycle numbers go on; only their times move.
    ++schedule.clock_steps;
    schedule.start_ns = now_ns - schedule.next_cycle * schedule.period_ns;
  }
  const std::int64_t due_cycle = (now_ns - schedule.start_ns) / schedule.period_ns;
  if (due_cycle > schedule.next_cycle) {
    wake.skipped = static_cast<std::uint64_t>(due_cycle - schedule.next_cycle);
    schedule.missed += wake.skipped;
    schedule.longest_miss = std::max(schedule.longest_miss, wake.skipped);
    schedule.next_cycle = due_cycle;
  }
  wake.cycle = schedule.next_cycle;
  wake.due_ns = schedule.start_ns + schedule.next_cycle * schedule.period_ns;
  wake.late_ns = std::max<std::int64_t>(now_ns - wake.due_ns, 0);
  ++schedule.next_cycle;
  return wake;
}

WakeUp wait_for_next_cycle(Schedule& schedule, Clock& clock) noexcept {
  const std::int64_t due_ns = schedule.start_ns + schedule.next_cycle * schedule.period_ns;
  std::int64_t now_ns = clock.now_ns();
  while (now_ns < due_ns) {
    const std::int64_t before_ns = now_ns;
    clock.sleep_until(due_ns);
    now_ns = clock.now_ns();
    if (now_ns < before_ns - schedule.period_ns) break;  // the clock went back: let the accounting decide
  }
  return account_wake_up(schedule, now_ns);
}

}  // namespace handloop::device
