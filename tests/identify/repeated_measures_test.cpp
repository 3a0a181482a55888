#include "identify/repeated_measures.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <stdexcept>

namespace handloop::identify {
namespace {

/// 15 subjects at 3 conditions from a congruential sequence: a subject's own level, a step of 0.35 a condition, and
/// scatter that grows with the condition (no sphericity).
Eigen::MatrixXd made_up_study() {
  constexpr int kSubjects = 15, kConditions = 3;
  std::uint32_t seed = 5;
  Eigen::VectorXd v(kSubjects * (kConditions + 2));
  for (auto& x : v) {
    seed = seed * 1664525u + 1013904223u;
    x = seed / 4294967296.0 - 0.5;
  }
  Eigen::MatrixXd y(kSubjects, kConditions);
  for (int i = 0; i < kSubjects; ++i) {
    for (int j = 0; j < kConditions; ++j)
      y(i, j) = 3 * v(i) + 0.35 * j + v(kSubjects + i * kConditions + j) * (1 + 1.5 * j);
  }
  return y;
}

// Expected: F by sums of squares, epsilon from the eigenvalues of the orthonormal contrasts' covariance, tails and
// paired t tests of scipy.stats, all in Python.
TEST(RepeatedMeasures, AgreesWithScipy) {
  const auto r = repeated_measures(made_up_study());
  EXPECT_NEAR(r.F, 1.1253153205183575, 1e-10);
  EXPECT_NEAR(r.p, 0.33878984025094466, 1e-10);
  EXPECT_NEAR(r.epsilon, 0.747952843365228, 1e-10);
  EXPECT_NEAR(r.p_greenhouse_geisser, 0.32735051869080667, 1e-10);
  ASSERT_EQ(r.pairs.size(), 3u);
  EXPECT_NEAR(r.pairs[0].t, 1.7358514371936893, 1e-10);
  EXPECT_NEAR(r.pairs[0].p, 0.10453562300985048, 1e-10);
  EXPECT_NEAR(r.pairs[1].p, 0.19041819940659171, 1e-10);
  EXPECT_NEAR(r.pairs[0].p_holm_sidak, 0.2819661131547748, 1e-10);
  EXPECT_NEAR(r.pairs[1].p_holm_sidak, 0.34457730814793485, 1e-10);
  EXPECT_NEAR(r.pairs[2].p_holm_sidak, 0.9889086618457218, 1e-9);
}

TEST(RepeatedMeasures, DifferencesBetweenSubjectsDoNotCount) {
  auto y = made_up_study();
  const double F = repeated_measures(y).F;
  for (int i = 0; i < y.rows(); ++i) y.row(i).array() += 100.0 * i;
  EXPECT_NEAR(repeated_measures(y).F, F, 1e-6);
}

TEST(RepeatedMeasures, TwoConditionsAreAPairedTTest) {
  const Eigen::MatrixXd y = made_up_study().leftCols(2);
  const auto r = repeated_measures(y);
  EXPECT_NEAR(r.F, r.pairs[0].t * r.pairs[0].t, 1e-9);
  EXPECT_NEAR(r.p, r.pairs[0].p, 1e-10);
  EXPECT_NEAR(r.p_greenhouse_geisser, r.p, 1e-10);  // one contrast is always spherical
}

TEST(RepeatedMeasures, AClearEffectIsFoundAndNothingIsNotOne) {
  auto y = made_up_study();
  y.col(2).array() += 5;
  const auto r = repeated_measures(y);
  EXPECT_LT(r.p_greenhouse_geisser, 1e-6);
  EXPECT_LT(r.pairs[1].p_holm_sidak, 1e-6);
  const auto none = repeated_measures(Eigen::MatrixXd::Constant(4, 3, 2.0));
  EXPECT_EQ(none.F, 0);
  EXPECT_EQ(none.p_greenhouse_geisser, 1);
  EXPECT_EQ(none.pairs[0].p_holm_sidak, 1);
}

TEST(RepeatedMeasures, RefusesIncompleteStudies) {
  EXPECT_THROW(repeated_measures(Eigen::MatrixXd::Zero(1, 3)), std::invalid_argument);
  EXPECT_THROW(repeated_measures(Eigen::MatrixXd::Zero(3, 1)), std::invalid_argument);
  Eigen::MatrixXd y = made_up_study();
  y(3, 1) = std::nan("");
  EXPECT_THROW(repeated_measures(y), std::invalid_argument);
}

}  // namespace
}  // namespace handloop::identify
