#include "control/controllers/virtual_wall.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "control/controllers/phantom_mechanism.h"
#include "models/errors.h"

namespace handloop::control {
namespace {

constexpr double kT = 1e-3;

VirtualWall::Settings settings(bool bilateral) {
  VirtualWall::Settings s;
  s.row = 2;
  s.plane_m = 0.05;
  s.bilateral = bilateral;
  s.gains = {700.0, 2.5, 80.0};
  return s;
}

ControllerInput at(double z_m) {
  ControllerInput input;
  input.mechanism.tip_m = {0.3, -0.1, z_m};
  input.mechanism.gravity_torque_Nm = {0.0, 0.1, 0.02};
  return input;
}

TEST(VirtualWall, IsTheTransferFunctionOfTheMargins) {
  // C(z) = K + B (1 - a)/T (z - 1)/(z - a): its impulse response is K + g at 0 and g (a - 1) a^(n-1) after, g = B (1 -
  // a)/T.
  VirtualWall wall(settings(true));
  const double a = std::exp(-2.0 * std::numbers::pi * 80.0 * kT);
  const double g = 2.5 * (1.0 - a) / kT;
  wall.step(at(0.05));
  const double impulse_m = 1e-3;
  for (int n = 0; n < 60; ++n) {
    const double force = wall.step(at(0.05 + (n == 0 ? impulse_m : 0.0))).force_N[2];
    const double c = n == 0 ? 700.0 + g : g * (a - 1.0) * std::pow(a, n - 1);
    EXPECT_NEAR(force, -c * impulse_m, 1e-11) << n;
  }
}

TEST(VirtualWall, ActsOnItsAxisOnlyAndOnlyBeyondThePlane) {
  VirtualWall wall(settings(false));
  for (const double z : {0.0, 0.02, 0.049}) {
    const auto output = wall.step(at(z));
    EXPECT_EQ(output.force_N, Eigen::Vector3d::Zero());
    EXPECT_FALSE(output.in_contact);
  }
  wall.reset();
  wall.step(at(0.052));
  const auto output = wall.step(at(0.052));
  EXPECT_TRUE(output.in_contact);
  EXPECT_NEAR(output.force_N[2], -700.0 * 0.002, 1e-12);
  EXPECT_EQ(output.force_N[0], 0.0);
  EXPECT_EQ(output.force_N[1], 0.0);
}

TEST(VirtualWall, NeverPullsTheHandIn) {
  VirtualWall wall(settings(false));
  wall.step(at(0.06));
  // Leaving fast, the damper alone would hold the hand back.
  for (double z = 0.06; z > 0.05; z -= 0.001) EXPECT_LE(wall.step(at(z)).force_N[2], 0.0);
}

TEST(VirtualWall, FirstSampleInsideTheWallIsNoBlow) {
  VirtualWall wall(settings(false));
  EXPECT_NEAR(wall.step(at(0.053)).force_N[2], -700.0 * 0.003, 1e-12);
}

TEST(VirtualWall, NewGainsActAtTheNextSample) {
  VirtualWall wall(settings(true));
  wall.step(at(0.051));
  EXPECT_TRUE(wall.set_gains({100.0, 0.0, 80.0}));
  EXPECT_NEAR(wall.step(at(0.051)).force_N[2], -0.1, 1e-12);
}

TEST(VirtualWall, ImpossibleGainsAreIgnored) {
  VirtualWall wall(settings(true));
  const double nan = std::nan("");
  for (const VirtualWallGains& bad : {VirtualWallGains{nan, 1, 100}, VirtualWallGains{-1, 1, 100}, VirtualWallGains{1, -1, 100}, VirtualWallGains{1, 1, 0},
                               VirtualWallGains{std::numeric_limits<double>::infinity(), 1, 100}}) {
    EXPECT_FALSE(wall.set_gains(bad));
  }
  EXPECT_EQ(wall.gains().stiffness_N_per_m, 700.0);
  auto s = settings(true);
  s.gains.damping_Ns_per_m = nan;
  EXPECT_THROW(VirtualWall{s}, InputError);
  s = settings(true);
  s.sample_time_s = 0.0;
  EXPECT_THROW(VirtualWall{s}, InputError);
}

TEST(VirtualWall, ANotFinitePositionGivesANotFiniteForceForTheLoopToFind) {
  VirtualWall wall(settings(false));
  EXPECT_FALSE(std::isfinite(wall.step(at(std::nan(""))).force_N[2]));
}

TEST(VirtualWall, FeedsGravityForwardWhereAskedTo) {
  auto s = settings(false);
  EXPECT_EQ(VirtualWall(s).step(at(0.0)).feedforward_torque_Nm, Eigen::Vector3d(0.0, 0.1, 0.02));
  s.gravity_compensation = false;
  EXPECT_EQ(VirtualWall(s).step(at(0.0)).feedforward_torque_Nm, Eigen::Vector3d::Zero());
}

TEST(PhantomMechanism, BoundsTheGravityOfEveryPose) {
  const auto mechanism = make_mechanism({});
  const Eigen::Vector3d bound = mechanism->feedforward_bound_Nm();
  for (double q2 = -2.0; q2 < 2.0; q2 += 0.1) {
    for (double q3 = -0.5; q3 < 3.7; q3 += 0.1) {
      const Eigen::Vector3d torque = mechanism->at({0.3, q2, q3}).gravity_torque_Nm.cwiseAbs();
      EXPECT_TRUE((torque.array() <= bound.array()).all()) << q2 << " " << q3;
    }
  }
  EXPECT_LT(bound.maxCoeff(), 0.2);
}

TEST(PhantomMechanism, TheCounterweightTakesTheStylusOffJointTwo) {
  models::DeviceSettings device;
  device.counterbalanced = true;
  const auto with = make_mechanism(device);
  device.stylus_mass_kg = 0.0;
  device.counterbalanced = false;
  const auto bare = make_mechanism(device);
  for (const double q2 : {-0.5, 0.0, 0.8}) {
    EXPECT_NEAR(with->at({0, q2, 0.3}).gravity_torque_Nm[1], bare->at({0, q2, 0.3}).gravity_torque_Nm[1], 1e-12);
  }
}

}  // namespace
}  // namespace handloop::control
