#include "identify/sampled_arm.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>
#include <unsupported/Eigen/MatrixFunctions>

#include "tests/support/arm_recording.h"

namespace handloop::identify {
namespace {

using Complex = std::complex<double>;
using models::ArmParameters;

constexpr double kT = 0.001;

/// The pulse transfer function by matrix exponential of the state equations: stretch of the grasp, arm position,
/// velocity.
Complex by_matrix_exponential(const ArmParameters& a, Hold hold, double w) {
  Eigen::Matrix<double, 5, 5> big = Eigen::Matrix<double, 5, 5>::Zero();
  big.topLeftCorner<3, 3>() << -a.k1_N_per_m / a.b1_Ns_per_m, 0, 0, 0, 0, 1, 0, -a.k2_N_per_m / a.mass_kg,
      -a.b2_Ns_per_m / a.mass_kg;
  big.block<3, 1>(0, 3) << 1 / a.b1_Ns_per_m, 0, 1 / a.mass_kg;
  big *= kT;
  big(3, 4) = 1;
  const Eigen::Matrix<double, 5, 5> e = big.exp();
  const Complex z = std::polar(1.0, w * kT);
  const Eigen::Vector3d g0 = e.block<3, 1>(0, 3), g1 = e.block<3, 1>(0, 4);
  Eigen::Vector3cd input = g0.cast<Complex>();
  if (hold == Hold::first_order) input += (z - 1.0) * g1;
  const Eigen::Matrix3cd left = z * Eigen::Matrix3cd::Identity() - e.topLeftCorner<3, 3>();
  const Eigen::Vector3cd x = left.partialPivLu().solve(input);
  return x(0) + x(1);
}

const std::array kArms{
    ArmParameters{0.2179, 379.5, 78.75, 1.839, 4.645},   // Table II, X
    ArmParameters{0.2041, 769.9, 271.7, 0.7764, 18.06},  // Table II, Z: overdamped
    ArmParameters{0.0003, 590.3, 588.7, 0.0002, 28.88},  // extremes of Table III: poles at -3e6 and -1e5
    ArmParameters{0.25, 400.0, 100.0, 2.0, 10.0},        // critically damped: equal poles
    ArmParameters{11.6, 1e4, 243.0, 200.0, 17.3}};

TEST(SampledArm, AgreesWithTheMatrixExponentialForEveryHoldAndArm) {
  for (const auto& arm : kArms) {
    for (const Hold hold : {Hold::zero_order, Hold::first_order}) {
      const SampledArm model(arm, hold, kT);
      for (double f = 0.3; f < 499; f *= 1.6) {
        const double w = 2 * std::numbers::pi * f;
        const Complex expected = by_matrix_exponential(arm, hold, w);
        EXPECT_LT(std::abs(model(w) - expected) / std::abs(expected), 1e-8)
            << arm.mass_kg << " " << f;  // residual 3e-11
      }
    }
  }
}

TEST(SampledArm, TendsToEquationOneAtLowFrequency) {
  for (const auto& arm : kArms) {
    const double w = 2 * std::numbers::pi * 0.05;
    const Complex truth = models::compliance(arm, Complex(0, w));
    EXPECT_LT(std::abs(SampledArm(arm, Hold::continuous, kT)(w) - truth), 1e-15);
    EXPECT_LT(std::abs(SampledArm(arm, Hold::first_order, kT)(w) / truth - 1.0), 1e-6);
    // The held force is half a sample late (unless poles beyond the sampling rate follow its steps).
    if (arm.mass_kg < 0.01) continue;
    EXPECT_LT(std::abs(SampledArm(arm, Hold::zero_order, kT)(w) / truth * std::polar(1.0, w * kT / 2) - 1.0), 2e-4);
  }
}

TEST(SampledArm, DerivativesAreThoseOfItsValues) {
  for (const auto& arm : kArms) {
    for (const Hold hold : {Hold::continuous, Hold::zero_order, Hold::first_order}) {
      for (const double f : {0.7, 4.0, 29.0}) {
        const double w = 2 * std::numbers::pi * f;
        std::array<Complex, 5> derivative;
        const Complex value = SampledArm(arm, hold, kT).gradient(w, derivative);
        EXPECT_LT(std::abs(value - SampledArm(arm, hold, kT)(w)), 1e-14 * std::abs(value) + 1e-17);
        for (std::size_t i = 0; i < 5; ++i) {
          auto up = models::to_array(arm), down = up;
          const double h = 1e-4 * up[i];
          up[i] += h;
          down[i] -= h;
          const Complex numeric = (SampledArm(models::arm_from_array(up), hold, kT)(w) -
                                   SampledArm(models::arm_from_array(down), hold, kT)(w)) /
                                  (2 * h);
          // Relative to how much the response as a whole would move: differences of nearly equal numbers carry its
          // rounding.
          EXPECT_LT(std::abs(derivative[i] - numeric) * up[i],
                    1e-5 * std::abs(numeric) * up[i] + 1e-8 * std::abs(value))
              << models::kArmParameterNames[i] << " hold " << hold_name(hold) << " mass " << arm.mass_kg;
        }
      }
    }
  }
}

TEST(SampledArm, SimulatesWhatTheDifferentialEquationsGive) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const auto& arm : test::random_arms(axis, 5, 3)) {
      for (const auto drive : {test::Drive::held_force, test::Drive::ramped_force}) {
        test::RecordingPlan plan;
        plan.arm = arm;
        plan.drive = drive;
        plan.duration_s = 10;
        plan.force_noise_N = plan.force_step_N = 0;
        const auto r = test::record_arm(plan);
        const Hold hold = drive == test::Drive::held_force ? Hold::zero_order : Hold::first_order;
        const auto position = SampledArm(models::arm_from_array(arm), hold, kT).simulate(r.force_N);
        double worst = 0;
        // At the very start a ramp comes from 0 for the one and from the first sample for the other: forgotten in 4 s.
        for (std::size_t n = 4000; n < position.size(); ++n) {
          worst = std::max(worst, std::abs(position[n] - r.true_position_m[n]));
        }
        EXPECT_LT(worst, 1e-9) << "axis " << axis << " hold " << hold_name(hold);  // residual 4e-11 m
      }
    }
  }
}

}  // namespace
}  // namespace handloop::identify
