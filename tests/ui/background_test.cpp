#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <fstream>
#include <functional>
#include <thread>

#include "io/scenario_file.h"
#include "ui/background/explain_job.h"
#include "ui/background/latest_job.h"
#include "ui/background/tuning_jobs.h"
#include "ui/session/live_session.h"

namespace handloop::ui {
namespace {

using namespace std::chrono_literals;

/// Waits for what must come; the limit only ends a test that has failed.
bool soon(const std::function<bool()>& come) {
  for (int i = 0; i < 6000; ++i) {
    if (come()) return true;
    std::this_thread::sleep_for(10ms);
  }
  return false;
}

/// Starts work that ends only where it is cancelled, and waits until it runs.
bool begin_endless(LatestJob<int>& job, std::atomic<bool>& begun) {
  job.request([&](JobContext& context) {
    begun = true;
    while (!context.cancelled()) std::this_thread::sleep_for(1ms);
    return std::optional(1);
  });
  return soon([&] { return begun.load(); });
}

TEST(LatestJob, GivesTheAnswerOnce) {
  LatestJob<int> job;
  job.request([](JobContext&) { return std::optional(7); });
  std::optional<int> answer;
  ASSERT_TRUE(soon([&] { return (answer = job.take()).has_value(); }));
  EXPECT_EQ(*answer, 7);
  EXPECT_FALSE(job.take());
  EXPECT_TRUE(soon([&] { return !job.busy(); }));
}

TEST(LatestJob, StopsWhatIsOutdatedAndAnswersTheNewest) {
  LatestJob<int> job;
  std::atomic<bool> begun{false};
  ASSERT_TRUE(begin_endless(job, begun));
  job.request([](JobContext&) { return std::optional(2); });
  std::optional<int> answer;
  ASSERT_TRUE(soon([&] { return (answer = job.take()).has_value(); }));
  EXPECT_EQ(*answer, 2);
}

TEST(LatestJob, AnswersNothingThatWasCancelled) {
  LatestJob<int> job;
  std::atomic<bool> begun{false};
  ASSERT_TRUE(begin_endless(job, begun));
  job.cancel();
  ASSERT_TRUE(soon([&] { return !job.busy(); }));
  EXPECT_FALSE(job.take());
}

TEST(LatestJob, TellsAnErrorAndGoesOn) {
  LatestJob<int> job;
  job.request([](JobContext&) -> std::optional<int> { throw std::runtime_error("no such thing"); });
  std::string error;
  ASSERT_TRUE(soon([&] { return !(error = job.take_error()).empty(); }));
  EXPECT_EQ(error, "no such thing");
  job.request([](JobContext&) { return std::optional(3); });
  EXPECT_TRUE(soon([&] { return job.take().has_value(); }));
}

TEST(LatestJob, EndsWithWorkStillRunning) {
  std::atomic<bool> begun{false};
  {
    LatestJob<int> job;
    job.request([&](JobContext& context) -> std::optional<int> {
      begun = true;
      while (!context.cancelled()) std::this_thread::sleep_for(1ms);
      return std::nullopt;
    });
    ASSERT_TRUE(soon([&] { return begun.load(); }));
  }
  SUCCEED();
}

TEST(TuningJobs, KeepsUpWithTheScenario) {
  TuningJobs jobs;
  auto scenario = io::default_scenario();
  jobs.follow(scenario, 1);
  ASSERT_TRUE(jobs.nominal());  // at once: no effect
  EXPECT_TRUE(jobs.nominal()->margins.stable);
  scenario.loop.stiffness_N_per_m = 5000;
  jobs.follow(scenario, 2);
  EXPECT_FALSE(jobs.nominal()->margins.stable);
  ASSERT_TRUE(soon([&] {
    jobs.follow(scenario, 2);
    return jobs.robust() && jobs.population() && jobs.limits() && !jobs.busy();
  }));
  EXPECT_EQ(jobs.population()->stable.trials, TuningJobs::kArms);
  EXPECT_GE(jobs.robust()->window.stiffness_high, 5000);
}

TEST(TuningJobs, SaysWhatIsWrongAndRecovers) {
  TuningJobs jobs;
  auto scenario = io::default_scenario();
  scenario.device.model = models::DeviceModel::seven_bar;
  jobs.follow(scenario, 1);
  EXPECT_FALSE(jobs.nominal());
  EXPECT_FALSE(jobs.problem().empty());
  jobs.follow(io::default_scenario(), 2);
  EXPECT_TRUE(jobs.nominal());
  EXPECT_TRUE(jobs.problem().empty());
}

class Session : public ::testing::Test {
 protected:
  void frame() { session.follow(scenario, revision); }
  bool until(const std::function<bool()>& come) {
    return soon([&] {
      frame();
      return come();
    });
  }
  models::Scenario scenario = io::default_scenario();
  std::uint64_t revision = 1;
  LiveSession session;
};

TEST_F(Session, RunsTheSimulationAndShowsItsSamples) {
  ASSERT_TRUE(until([&] { return session.traces().count() > 300; }));
  EXPECT_TRUE(session.running());
  EXPECT_FALSE(session.faulted());
}

TEST_F(Session, StepsSingleSamplesWhilePaused) {
  ASSERT_TRUE(until([&] { return session.running(); }));
  session.set_paused(true);
  std::this_thread::sleep_for(50ms);
  frame();
  const auto before = session.traces().count();
  std::this_thread::sleep_for(50ms);
  frame();
  EXPECT_EQ(session.traces().count(), before);
  session.single_step();
  ASSERT_TRUE(until([&] { return session.traces().count() > before; }));
  std::this_thread::sleep_for(50ms);
  frame();
  EXPECT_EQ(session.traces().count(), before + 1);
}

TEST_F(Session, GivesNewGainsToTheRunningLoop) {
  ASSERT_TRUE(until([&] { return session.status().steps > 10; }));
  scenario.loop.stiffness_N_per_m = 777;
  ++revision;
  ASSERT_TRUE(until([&] { return session.status().gains.stiffness_N_per_m == 777; }));
  EXPECT_GT(session.status().steps, 10u);  // the same loop, not a new one
  EXPECT_FALSE(session.change_waits());
}

TEST_F(Session, MakesANewLoopForAnotherPlant) {
  ASSERT_TRUE(until([&] { return session.last().step > 200; }));
  scenario.loop.delay_samples = 3;
  ++revision;
  frame();
  EXPECT_TRUE(until([&] { return session.last().step < 150; }));
}

TEST_F(Session, StopTakesTheForceAwayUntilReset) {
  scenario.wall.position_m = -0.002;  // in the wall from the start
  ASSERT_TRUE(until([&] { return session.last().wanted_force_N.norm() > 0.3; }));
  session.stop();
  ASSERT_TRUE(until([&] { return session.faulted() && session.last().fault == device::Fault::external; }));
  ASSERT_TRUE(until([&] { return session.last().written_force_N.norm() == 0.0 && !session.evidence().empty(); }));
  const auto& first = session.evidence().front();
  EXPECT_EQ(first.fault, device::Fault::none);
  EXPECT_EQ(session.evidence().back().fault, device::Fault::external);
  session.reset();
  EXPECT_TRUE(
      until([&] { return session.running() && !session.faulted() && session.last().fault == device::Fault::none; }));
}

TEST_F(Session, PullsTheStylusWhereTheMouseHoldsIt) {
  scenario.hand.push_N = 0.0;
  scenario.wall.position_m = 0.1;
  ASSERT_TRUE(until([&] { return session.last().step > 100; }));
  const Eigen::Vector3d home = session.home_tip_m();
  session.pull({.anchor_m = {home.x() + 0.05, home.y(), home.z()}, .stiffness_N_per_m = 120, .damping_Ns_per_m = 1});
  ASSERT_TRUE(until([&] { return session.last().tip_m.x() - home.x() > 0.005; }));
  session.pull({});
  EXPECT_TRUE(until([&] { return session.last().tip_m.x() - home.x() < 0.002; }));
}

TEST_F(Session, StartsNoRealDeviceWithoutArming) {
  ASSERT_TRUE(until([&] { return session.running(); }));
  session.use_device("udp://127.0.0.1:9");
  for (int i = 0; i < 20; ++i) {
    frame();
    std::this_thread::sleep_for(5ms);
  }
  EXPECT_FALSE(session.running());
  session.start_armed();
  frame();
  EXPECT_FALSE(session.running());
  EXPECT_FALSE(session.preparing());
}

TEST_F(Session, SaysWhyADeviceCannotBeHad) {
  ASSERT_TRUE(until([&] { return session.running(); }));
  session.use_device("comedi:/nowhere/rig.toml");
  auto& arming = session.arming();
  arming.open_cover(0);
  arming.hold(true, 0);
  ASSERT_TRUE(arming.hold(true, 2));
  session.start_armed();
  ASSERT_TRUE(until([&] { return !session.problem().empty(); }));
  EXPECT_NE(session.problem().find("/nowhere/rig.toml"), std::string::npos);
  EXPECT_FALSE(session.running());
  EXPECT_FALSE(session.arming().armed());
}

TEST(ExplainJob, SaysInOneLineWhyAFileIsNoRecording) {
  ExplainJob job;
  job.start({"/nowhere/recording.csv", {}});
  ASSERT_TRUE(soon([&] {
    job.follow();
    return !job.problem().empty();
  }));
  EXPECT_NE(job.problem().find("/nowhere/recording.csv"), std::string::npos);
  EXPECT_FALSE(job.result());
}

}  // namespace
}  // namespace handloop::ui
