#include "control/multi_axis.h"

#include <gtest/gtest.h>

#include <cmath>

#include "control/structured_singular_value.h"
#include "models/arm_tables.h"
#include "models/errors.h"

namespace handloop::control {
namespace {

TEST(Mu, OfTwoComplexNumbersOffTheDiagonalIsTheirGeometricMean) {
  Eigen::Matrix2cd M;
  M << 0, 3, std::complex<double>(0, 0.5), 0;
  EXPECT_NEAR(mu_upper_bound(M, {{1, false}, {1, false}}).value, std::sqrt(1.5), 1e-6);
}

TEST(Mu, OfRankOneIsTheSumOfProducts) {
  const Eigen::Vector3cd u(1, std::complex<double>(0.2, -2), 0.5), v(std::complex<double>(0, 1), 0.3, -1.4);
  const Eigen::Matrix3cd M = u * v.adjoint();
  const double expected = std::abs(u(0) * v(0)) + std::abs(u(1) * v(1)) + std::abs(u(2) * v(2));
  EXPECT_NEAR(mu_upper_bound(M, {{1, false}, {1, false}, {1, false}}).value, expected, 1e-5 * expected);
}

TEST(Mu, RefusesBlocksThatDoNotFit) {
  EXPECT_THROW(mu_upper_bound(Eigen::Matrix2cd::Identity(), {{1, false}}), InputError);
  EXPECT_THROW(mu_upper_bound(Eigen::Matrix2cd::Identity(), {{2, true}}), InputError);
}

MultiAxisPlant held() {
  MultiAxisPlant plant;
  for (const auto axis : models::kAxes) plant.arms[static_cast<std::size_t>(axis)] = models::nominal_arm(axis);
  return plant;
}

TEST(MultiAxis, UncoupledAxesHaveTheSmallestOfTheirMargins) {
  const WallGains wall{400, 1};
  const auto all = evaluate(held(), {}, {wall, wall, wall});
  ASSERT_TRUE(all.stable);
  double least = 9, rho = 0;
  for (const auto axis : models::kAxes) {
    const Margins one = evaluate({{0.075, 0.05, models::nominal_arm(axis)}, {}, wall});
    rho = std::max(rho, one.rho);
    least = std::min(least, one.disk_alpha);
    EXPECT_NEAR(all.one_at_a_time[static_cast<std::size_t>(axis)] / one.disk_alpha, 1, 2e-2);  // on its grid
  }
  EXPECT_NEAR(all.rho, rho, 1e-10);
  EXPECT_NEAR(all.disk_alpha / least, 1, 1e-5);
  EXPECT_EQ(all.worst_direction_name, "z (forward-backward)");
}

TEST(MultiAxis, CouplingCanOnlyTakeFromTheMarginOfOneLoopAlone) {
  auto plant = held();
  plant.tip_inertia_kg << 0.08, 0.02, 0.01, 0.02, 0.1, -0.015, 0.01, -0.015, 0.06;
  const WallGains wall{400, 1};
  const auto all = evaluate(plant, {}, {wall, wall, wall});
  ASSERT_TRUE(all.stable);
  for (const double alone : all.one_at_a_time) EXPECT_LE(all.disk_alpha, alone * (1 + 1e-6));
}

/// A pose only turns the axes: with equal arms and walls on all of them, turning the inertia changes nothing.
TEST(MultiAxis, PolesDoNotDependOnHowEqualAxesAreTurned) {
  MultiAxisPlant plant;
  for (auto& arm : plant.arms) arm = models::nominal_arm(models::Axis::x);
  plant.tip_inertia_kg = Eigen::Vector3d(0.05, 0.08, 0.12).asDiagonal();
  const WallGains wall{500, 1};
  const double straight = evaluate(plant, {}, {wall, wall, wall}).rho;
  Eigen::Matrix3d turn;  // any rotation: from a unit quaternion's formula
  const double a = 0.6, b = 0.3;
  turn << std::cos(a), -std::sin(a) * std::cos(b), std::sin(a) * std::sin(b), std::sin(a), std::cos(a) * std::cos(b),
      -std::cos(a) * std::sin(b), 0, std::sin(b), std::cos(b);
  plant.tip_inertia_kg = turn * plant.tip_inertia_kg * turn.transpose();
  EXPECT_NEAR(evaluate(plant, {}, {wall, wall, wall}).rho, straight, 1e-10);
}

}  // namespace
}  // namespace handloop::control
