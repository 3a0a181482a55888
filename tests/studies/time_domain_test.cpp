#include "studies/time_domain.h"

#include <gtest/gtest.h>

#include <cmath>

#include "control/margins.h"
#include "control/stability_boundary.h"
#include "io/scenario_file.h"
#include "models/scenario_tip.h"
#include "studies/sweep_truth.h"
#include "tests/heap_counter/heap_counter.h"

namespace handloop::studies {
namespace {

models::Scenario ideal_scenario(models::Axis axis) {
  models::Scenario s = still_scenario(io::default_scenario(), axis);
  s.electronics.ideal = true;
  return s;
}

double critical(const models::Scenario& s, double damping) {
  const models::ScenarioTip tip = models::tip_of(s, s.wall.axis);
  const control::LoopTiming timing{s.loop.sample_time_s, s.loop.delay_samples, s.loop.cutoff_Hz};
  const auto plant = control::sample_plant(
      {tip.mass_kg, tip.damping_Ns_per_m, s.arm.axes[static_cast<std::size_t>(s.wall.axis)]}, timing.sample_time_s);
  return control::critical_stiffness(plant, timing, damping);
}

TEST(TimeDomainLoop, FindsTheCriticalStiffnessOfTheLinearLoopOnEveryAxis) {
  for (const models::Axis axis : models::kAxes) {
    const models::Scenario s = ideal_scenario(axis);
    const double k = critical(s, 1.0);
    TimeDomainLoop loop(s);
    EXPECT_TRUE(loop.judge(0.97 * k, 1.0).stable) << models::axis_name(axis);
    EXPECT_FALSE(loop.judge(1.03 * k, 1.0).stable) << models::axis_name(axis);
  }
}

TEST(TimeDomainLoop, GrowsAsFastAsTheLargestPoleSays) {
  const models::Scenario s = ideal_scenario(models::Axis::z);
  const double k = 1.1 * critical(s, 1.0);
  const models::ScenarioTip tip = models::tip_of(s, models::Axis::z);
  control::Loop linear;
  linear.plant = {tip.mass_kg, tip.damping_Ns_per_m, s.arm.axes[2]};
  linear.timing = {s.loop.sample_time_s, s.loop.delay_samples, s.loop.cutoff_Hz};
  linear.gains = {k, 1.0};
  const double rho = control::evaluate(linear).rho;
  ASSERT_GT(rho, 1);
  const TimeDomainVerdict verdict = TimeDomainLoop(s).judge(k, 1.0);
  EXPECT_FALSE(verdict.stable);
  EXPECT_NEAR(std::log(verdict.growth_per_sample), std::log(rho), 0.3 * std::log(rho));  // a window long at most
}

TEST(TimeDomainLoop, AnswersTheSameTwiceAndAfterOtherQuestions) {
  TimeDomainLoop loop(still_scenario(io::default_scenario(), models::Axis::z));
  const TimeDomainVerdict first = loop.judge(500, 1);
  loop.judge(3000, 0);
  const TimeDomainVerdict again = loop.judge(500, 1);
  EXPECT_EQ(first.growth_per_sample, again.growth_per_sample);
  EXPECT_EQ(first.swing_m, again.swing_m);
}

TEST(TimeDomainLoop, TakesNothingFromTheHeapOnceMade) {
  for (const bool ideal : {true, false}) {
    models::Scenario s = still_scenario(io::default_scenario(), models::Axis::x);
    s.electronics.ideal = ideal;
    TimeDomainLoop loop(s);
    TimeDomainVerdict verdict;
    EXPECT_EQ(test::heap_allocations_of([&] { verdict = loop.judge(300, 1); }), 0u) << ideal;
    EXPECT_GT(verdict.samples, 500u);
  }
}

TEST(TimeDomainLoop, ADecayThatLocksIntoACycleOfCountsIsStableAndItsSwingIsTold) {
  // 3 % inside the boundary of a stiff wall: the motion shrinks from the push and then goes round some encoder counts.
  // Without quantisation it dies out.
  models::Scenario s = still_scenario(io::default_scenario(), models::Axis::y);
  s.device.joint_coulomb_Nm = 0;
  const double k = 0.97 * critical(s, 2.3);
  const TimeDomainVerdict counted = TimeDomainLoop(s).judge(k, 2.3);
  EXPECT_TRUE(counted.stable);
  EXPECT_GT(counted.swing_m, 3e-5);  // an encoder count
  s.electronics.ideal = true;
  const TimeDomainVerdict smooth = TimeDomainLoop(s).judge(k, 2.3);
  EXPECT_TRUE(smooth.stable);
  EXPECT_LT(smooth.swing_m, 1e-6);
}

TEST(TruthCheck, TheSimulationAndTheLinearLoopAgreeNearTheBoundary) {
  SweepSettings settings;
  settings.scenario = io::default_scenario();
  settings.damping = {0.2, 4, 1};
  settings.seed = 7;
  const TruthCheck check = check_truth(settings, 6, 2, {});  // 200 of them: handloop sweep --truth-check 200
  EXPECT_GE(check.agreeing_ideal(), 6u) << check.text();
  EXPECT_GE(check.agreeing(), 5u) << check.text();  // 97 to 99.5 % of 200, by three seeds
  EXPECT_EQ(check.unexplained(), 0u) << check.text();
}

}  // namespace
}  // namespace handloop::studies
