#include "device/timing.h"

#include <gtest/gtest.h>

#include <functional>
#include <vector>

namespace handloop::device {
namespace {

constexpr std::int64_t kMs = 1'000'000;

/// A clock whose sleeps last as long as a script says: the delay beyond the wanted wake-up, by number of the sleep.
class ScriptedClock final : public Clock {
 public:
  std::int64_t now = 5'000 * kMs;
  std::function<std::int64_t(int sleep)> lateness = [](int) { return 0; };
  int sleeps = 0;

  std::int64_t now_ns() noexcept override { return now; }
  void sleep_until(std::int64_t wake_ns) noexcept override {
    const std::int64_t late = lateness(sleeps++);
    now = std::max(now, wake_ns) + late;
  }
};

TEST(Timing, WakesOnThePhaseOfItsStart) {
  ScriptedClock clock;
  auto schedule = begin_schedule(clock.now, kMs);
  const std::int64_t start = clock.now;
  for (int k = 0; k < 1000; ++k) {
    const WakeUp wake = wait_for_next_cycle(schedule, clock);
    EXPECT_EQ(wake.cycle, k);
    EXPECT_EQ(clock.now, start + k * kMs);
    EXPECT_EQ(wake.late_ns, 0);
  }
  EXPECT_EQ(schedule.missed, 0u);
}

TEST(Timing, LateWakeUpsDoNotAddUp) {
  ScriptedClock clock;
  clock.lateness = [](int) { return 300'000; };
  auto schedule = begin_schedule(clock.now, kMs);
  const std::int64_t start = clock.now;
  for (int k = 0; k < 1000; ++k) {
    const WakeUp wake = wait_for_next_cycle(schedule, clock);
    EXPECT_EQ(wake.due_ns, start + k * kMs);
    if (k > 0) {
      EXPECT_EQ(wake.late_ns, 300'000);
    }
  }
  EXPECT_EQ(schedule.missed, 0u);
}

TEST(Timing, AStallOf200MsIsSkippedCountedAndThePhaseKept) {
  ScriptedClock clock;
  clock.lateness = [](int sleep) { return sleep == 99 ? 200 * kMs + 250'000 : 0; };
  auto schedule = begin_schedule(clock.now, kMs);
  const std::int64_t start = clock.now;
  std::vector<WakeUp> wakes;
  for (int k = 0; k < 200; ++k) wakes.push_back(wait_for_next_cycle(schedule, clock));
  EXPECT_EQ(schedule.missed, 200u);
  EXPECT_EQ(schedule.longest_miss, 200u);
  EXPECT_EQ(wakes[100].skipped, 200u);
  EXPECT_EQ(wakes[100].cycle, 300);
  EXPECT_EQ(wakes[100].late_ns, 250'000);
  EXPECT_EQ(wakes[101].cycle, 301);
  EXPECT_EQ(wakes[101].due_ns, start + 301 * kMs);
  EXPECT_EQ(wakes[101].late_ns, 0);
}

TEST(Timing, DropOutsOfOneMillisecondCostOneCycleEach) {
  ScriptedClock clock;
  clock.lateness = [](int sleep) { return sleep % 10 == 9 ? kMs : 0; };
  auto schedule = begin_schedule(clock.now, kMs);
  for (int k = 0; k < 101; ++k) wait_for_next_cycle(schedule, clock);
  EXPECT_EQ(schedule.missed, 10u);
  EXPECT_EQ(schedule.longest_miss, 1u);
  EXPECT_EQ(schedule.next_cycle, 111);
}

TEST(Timing, ALoopThatTakesTooLongMissesButNeverRunsTwiceForOneCycle) {
  ScriptedClock clock;
  auto schedule = begin_schedule(clock.now, kMs);
  std::int64_t last = -1;
  for (int k = 0; k < 100; ++k) {
    const WakeUp wake = wait_for_next_cycle(schedule, clock);
    EXPECT_GT(wake.cycle, last);
    last = wake.cycle;
    clock.now += kMs + 700'000;  // the work
  }
  // 1.7 ms of work a cycle: seven cycles of ten pass unused, to within the last one.
  EXPECT_NEAR(static_cast<double>(schedule.missed), 0.7 * 99, 1.0);
}

TEST(Timing, AClockThatLeapsAheadIsAMissNotAFlood) {
  ScriptedClock clock;
  auto schedule = begin_schedule(clock.now, kMs);
  for (int k = 0; k < 10; ++k) wait_for_next_cycle(schedule, clock);
  clock.now += 3600LL * 1000 * kMs;
  const WakeUp wake = wait_for_next_cycle(schedule, clock);
  // It is still the moment of cycle 9, an hour on.
  EXPECT_EQ(wake.skipped, 3600u * 1000 - 1);
  EXPECT_EQ(wait_for_next_cycle(schedule, clock).skipped, 0u);
}

TEST(Timing, AClockThatGoesBackBeginsTheScheduleAnew) {
  ScriptedClock clock;
  auto schedule = begin_schedule(clock.now, kMs);
  for (int k = 0; k < 10; ++k) wait_for_next_cycle(schedule, clock);
  clock.now -= 10'000 * kMs;
  clock.lateness = [&](int) -> std::int64_t {
    ADD_FAILURE() << "would sleep ten seconds";
    return 0;
  };
  // The wait must not last until the old clock's time comes round again.
  const std::int64_t before = clock.now;
  const WakeUp wake = account_wake_up(schedule, clock.now);
  EXPECT_EQ(wake.cycle, 10);
  EXPECT_EQ(schedule.clock_steps, 1u);
  EXPECT_EQ(schedule.start_ns + schedule.next_cycle * schedule.period_ns, before + kMs);
  EXPECT_EQ(schedule.missed, 0u);
}

TEST(Timing, WaitingNoticesAClockThatGoesBackMeanwhile) {
  ScriptedClock clock;
  auto schedule = begin_schedule(clock.now, kMs);
  for (int k = 0; k < 10; ++k) wait_for_next_cycle(schedule, clock);
  const int so_far = clock.sleeps;
  clock.lateness = [&](int) -> std::int64_t { return -10'000 * kMs; };
  const WakeUp wake = wait_for_next_cycle(schedule, clock);
  EXPECT_EQ(clock.sleeps, so_far + 1);
  EXPECT_EQ(wake.cycle, 10);
  EXPECT_EQ(schedule.clock_steps, 1u);
}

TEST(Timing, SleepsThatEndEarlyAreGoneOnWith) {
  ScriptedClock clock;
  clock.lateness = [&](int sleep) { return sleep % 3 == 2 ? 0 : -kMs / 2; };
  auto schedule = begin_schedule(clock.now, kMs);
  const std::int64_t start = clock.now;
  for (int k = 0; k < 100; ++k) {
    wait_for_next_cycle(schedule, clock);
    EXPECT_GE(clock.now, start + k * kMs);
  }
  EXPECT_EQ(schedule.missed, 0u);
}

TEST(Timing, TheRealClockSleepsAtLeastAsLongAsAsked) {
  MonotonicClock clock;
  auto schedule = begin_schedule(clock.now_ns(), kMs);
  for (int k = 0; k < 20; ++k) {
    const WakeUp wake = wait_for_next_cycle(schedule, clock);
    EXPECT_GE(clock.now_ns(), wake.due_ns);
  }
}

}  // namespace
}  // namespace handloop::device
