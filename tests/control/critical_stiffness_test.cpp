#include <gtest/gtest.h>

#include <cmath>

#include "control/closed_loop_verdict.h"
#include "control/margins.h"
#include "control/stability_boundary.h"
#include "models/arm_tables.h"

/// Limits of stiffness found elsewhere: Jury's test by bisection with 30 digits.
namespace handloop::control {
namespace {

constexpr double kNoFilter = std::numeric_limits<double>::infinity();

double limit(const LoopPlant& plant, int delay, double damping, double cutoff = kNoFilter) {
  const LoopTiming timing{0.001, delay, cutoff};
  return critical_stiffness(sample_plant(plant, timing.sample_time_s), timing, damping);
}

TEST(CriticalStiffness, OfAFreeTipMatchesJurysTest) {
  struct Row {
    double m, b, B, K[3];
  };
  // m = 0.072, b = 0.005 and m = 5.4, b = 3.5: two devices of the literature; plain backward difference, T = 1 ms, d =
  // 0, 1, 2
  for (const Row& row : {Row{0.072, 0.005, 0, {10.0001157, 3.33339763, 2.00006018}},
                         Row{0.072, 0.005, 0.5, {1003.02223, 334.074129, 200.037118}},
                         Row{0.072, 0.005, 5, {9338.31881, 3077.86365, 1802.05202}},
                         Row{5.4, 3.5, 0, {7000.75625, 2333.75335, 1400.39307}},
                         Row{5.4, 3.5, 5, {16986.1066, 5661.85869, 3396.54846}}}) {
    for (int d = 0; d < 3; ++d) {
      const double K = limit({row.m, row.b, {}}, d, row.B);
      EXPECT_NEAR(K / row.K[d], 1, 1e-8) << row.m << ' ' << row.B << ' ' << d;  // the figures have nine digits
    }
  }
}

TEST(CriticalStiffness, WithoutDelayAndDampingFollowsTheClosedForm) {
  for (const double m : {0.02, 0.075, 5.4}) {
    for (const double b : {0.001, 0.05, 3.5}) {
      const double T = 0.001, e = std::exp(-b * T / m);
      const double expected = b * -std::expm1(-b * T / m) / (m / b * -std::expm1(-b * T / m) - T * e);
      if (b * T / m < 1e-4) continue;  // there the closed form itself loses its digits by cancellation
      EXPECT_NEAR(limit({m, b, {}}, 0, 0) / expected, 1, 1e-9) << m << ' ' << b;
    }
  }
}

TEST(CriticalStiffness, WithTheNominalArmMatchesJurysTest) {
  struct Row {
    models::ArmParameters arm;
    double light[2], heavy[2];  // tip of 75 g and 136 g, d = 0 and 1
  };
  // Table II and the operator of Diaz and Gil (Table V)
  for (const Row& row : {Row{models::nominal_arm(models::Axis::x), {3932.352, 1443.538}, {4112.701, 1607.912}},
                         Row{models::nominal_arm(models::Axis::y), {7550.560, 2687.841}, {7729.700, 2858.417}},
                         Row{models::nominal_arm(models::Axis::z), {2170.043, 975.9754}, {2725.431, 1369.938}},
                         Row{models::find_literature_arm("diaz").arm, {3797.594, 1606.277}, {5194.727, 2490.143}}}) {
    for (int d = 0; d < 2; ++d) {
      EXPECT_NEAR(limit({0.075, 0.005, row.arm}, d, 0) / row.light[d], 1, 1e-6) << row.arm.k1_N_per_m;
      EXPECT_NEAR(limit({0.136, 0.005, row.arm}, d, 0) / row.heavy[d], 1, 1e-6) << row.arm.k1_N_per_m;
    }
  }
}

}  // namespace
}  // namespace handloop::control
