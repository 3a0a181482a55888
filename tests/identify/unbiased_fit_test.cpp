#include "identify/unbiased_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "models/errors.h"
#include "tests/support/arm_recording.h"

namespace handloop::identify {
namespace {

/// Mean error over trials by parameter, relative to the mean of the true values.
struct Bias {
  std::array<double, 5> error{}, truth{};
  double of(std::size_t i) const { return error[i] / truth[i]; }
  void add(const models::ArmParameters& found, const std::array<double, 5>& arm) {
    const auto f = models::to_array(found);
    for (std::size_t i = 0; i < 5; ++i) {
      error[i] += f[i] - arm[i];
      truth[i] += arm[i];
    }
  }
};

test::RecordingPlan plan_for(int axis, std::size_t trial, const std::array<double, 5>& arm, test::Drive drive) {
  test::RecordingPlan plan;
  plan.arm = arm;
  plan.drive = drive;
  plan.seed = static_cast<std::uint64_t>(1000 * axis) + trial;
  plan.wander_rms_m = 5e-4;
  return plan;
}

// The bound: 0.5 % of every parameter's mean over 135 trials, b1 in Z 3 %. Found over 135 with this plan: 0.17
// % at most (b1 in Z), the rest below 0.08 %; here a third of the trials.
TEST(UnbiasedFit, MeanBiasIsBelowHalfAPercentWhateverHoldsTheForce) {
  for (const auto drive : {test::Drive::device, test::Drive::held_force, test::Drive::ramped_force}) {
    for (int axis = 0; axis < 3; ++axis) {
      const auto arms = test::random_arms(axis, 15, static_cast<std::uint64_t>(100 + axis));
      Bias bias;
      for (std::size_t trial = 0; trial < arms.size(); ++trial) {
        const auto r = test::record_arm(plan_for(axis, trial, arms[trial], drive));
        bias.add(fit_arm_unbiased(r.force_N, r.position_m, 0.001).fit.arm, arms[trial]);
      }
      for (std::size_t i = 0; i < 5; ++i) {
        const double limit = axis == 2 && i == 3 ? 0.03 : 0.005;
        EXPECT_LT(std::abs(bias.of(i)), limit) << "drive " << static_cast<int>(drive) << " axis " << axis << " " << i;
      }
    }
  }
}

TEST(UnbiasedFit, ThePapersMethodOnTheSameRecordingsIsBiasedAsKnown) {
  // A held force taken for a continuous one: b1 far too large. Short segments: M too small, b2 too large.
  Bias x, z;
  for (int axis : {0, 2}) {
    const auto arms = test::random_arms(axis, 10, static_cast<std::uint64_t>(100 + axis));
    for (std::size_t trial = 0; trial < arms.size(); ++trial) {
      const auto r = test::record_arm(plan_for(axis, trial, arms[trial], test::Drive::held_force));
      const auto h = frequency_response(welch(r.force_N, r.position_m, 0.001, paper_settings(0.001)));
      (axis == 0 ? x : z).add(fit_arm(h).arm, arms[trial]);
    }
  }
  EXPECT_GT(x.of(3), 0.05);   // +9 %
  EXPECT_GT(z.of(3), 0.4);    // +86 %
  EXPECT_GT(x.of(4), 0.015);  // +3 %
}

TEST(UnbiasedFit, TheRecordingSaysHowItsForceWasHeld) {
  for (int axis = 0; axis < 3; ++axis) {
    const auto arms = test::random_arms(axis, 4, 55);
    for (std::size_t trial = 0; trial < arms.size(); ++trial) {
      const auto held = test::record_arm(plan_for(axis, trial, arms[trial], test::Drive::held_force));
      const auto a = fit_arm_unbiased(held.force_N, held.position_m, 0.001);
      EXPECT_EQ(a.fit.hold, Hold::zero_order);
      EXPECT_TRUE(a.hold_is_clear);
      EXPECT_NEAR(a.misfit, 1, 0.5);  // chi squared a degree of freedom: 0.7 - 1.2
      const auto through = test::record_arm(plan_for(axis, trial, arms[trial], test::Drive::device));
      EXPECT_NE(fit_arm_unbiased(through.force_N, through.position_m, 0.001).fit.hold, Hold::zero_order);
    }
  }
}

TEST(UnbiasedFit, IntervalsHoldTheTruth) {
  int inside = 0, all = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const auto arms = test::random_arms(axis, 12, 77);
    for (std::size_t trial = 0; trial < arms.size(); ++trial) {
      const auto r = test::record_arm(plan_for(axis, trial, arms[trial], test::Drive::device));
      const auto fit = fit_arm_unbiased(r.force_N, r.position_m, 0.001).fit;
      for (std::size_t i = 0; i < 5; ++i, ++all)
        inside += fit.low95[i] <= arms[trial][i] && arms[trial][i] <= fit.high95[i];
    }
  }
  EXPECT_GT(inside, 0.93 * all);  // 0.99: what is not known of the hold makes them wide
}

TEST(UnbiasedFit, ADelayOfTheSensorIsFittedAndNamed) {
  auto plan = plan_for(0, 1, {0.3240, 459.4, 104.8, 2.579, 5.920}, test::Drive::device);
  const auto r = test::record_arm(plan);
  std::vector<double> late(r.position_m.size(), 0.0);
  for (std::size_t n = 2; n < late.size(); ++n) late[n] = r.position_m[n - 2];
  const auto fit = fit_arm_unbiased(r.force_N, late, 0.001).fit;
  EXPECT_NEAR(fit.delay_s, 0.002, 2e-5);  // 0.001 ms off
  EXPECT_NEAR(fit.arm.b1_Ns_per_m, 2.579, 0.02);
  ASSERT_FALSE(fit.warnings.empty());
  EXPECT_NE(fit.warnings.back().find("lags"), std::string::npos);
  EXPECT_NEAR(fit_arm_unbiased(r.force_N, r.position_m, 0.001).fit.delay_s, 0, 1e-9);
}

TEST(UnbiasedFit, ShortAndFastRecordingsAreFittedToo) {
  auto plan = plan_for(0, 2, {0.3240, 459.4, 104.8, 2.579, 5.920}, test::Drive::device);
  plan.wander_rms_m = 0;
  plan.duration_s = 5;
  auto r = test::record_arm(plan);
  EXPECT_NEAR(fit_arm_unbiased(r.force_N, r.position_m, 0.001).fit.arm.mass_kg / 0.3240, 1, 0.02);
  plan.duration_s = 20;
  plan.sample_time_s = 0.00025;
  r = test::record_arm(plan);
  EXPECT_NEAR(fit_arm_unbiased(r.force_N, r.position_m, 0.00025).fit.arm.mass_kg / 0.3240, 1, 0.005);
}

TEST(UnbiasedFit, RefusesWhatHoldsNoAnswer) {
  const std::vector<double> three{1, 2, 3}, constant(60000, 0.5);
  const auto r = test::record_arm(plan_for(0, 3, {0.3240, 459.4, 104.8, 2.579, 5.920}, test::Drive::device));
  EXPECT_THROW(fit_arm_unbiased(three, three, 0.001), InputError);
  EXPECT_THROW(fit_arm_unbiased(r.force_N, constant, 0.001), InputError);
  EXPECT_THROW(fit_arm_unbiased(constant, r.position_m, 0.001), InputError);
  auto broken = r.position_m;
  broken[100] = std::numeric_limits<double>::infinity();
  EXPECT_THROW(fit_arm_unbiased(r.force_N, broken, 0.001), InputError);
}

}  // namespace
}  // namespace handloop::identify
