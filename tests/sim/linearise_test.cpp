#include "sim/linearise.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "control/loop.h"
#include "control/sampled_plant.h"
#include "control/stability_boundary.h"
#include "tests/sim/plant_loop.h"

namespace handloop::sim {
namespace {

using namespace testing_support;
using Eigen::MatrixXd;
using Eigen::Vector3d;

TEST(Linearise, FindsTheTipMobilityOfTheClosedForm) {
  for (const auto set : {models::PhantomParameterSet::cavusoglu, models::PhantomParameterSet::cad}) {
    for (const auto& q : {std::array{0.0, 0.0, 0.0}, std::array{0.4, 0.3, 0.5}}) {
      auto scenario = nominal_scenario();
      scenario.device.parameter_set = set;
      scenario.device.pose_rad = q;
      const auto device = models::phantom_parameters(set, scenario.device.stylus_mass_kg);
      const Eigen::Matrix3d closed = models::phantom_tip_mobility(device, Vector3d(q[0], q[1], q[2]));
      // the gimbal's outer ring turns with the forearm: 1e-6 kg m^2 in 2.4e-3
      EXPECT_LT((tip_mobility(scenario) - closed).norm() / closed.norm(), 2e-3);
    }
  }
}

/// Spectral radius of the loop closed by a spring on one axis, delayed by whole samples.
double radius(const LinearisedPlant& plant, int axis, double stiffness, int delay) {
  const int n = 12 + delay;
  MatrixXd closed = MatrixXd::Zero(n, n);
  closed.topLeftCorner(12, 12) = plant.A;
  const Eigen::RowVectorXd spring = -stiffness * plant.C.row(axis);
  if (delay == 0) {
    closed.topLeftCorner(12, 12) += plant.B.col(axis) * spring;
  } else {
    closed.block(0, n - 1, 12, 1) = plant.B.col(axis);
    closed.block(12, 0, 1, 12) = spring;
    for (int i = 1; i < delay; ++i) closed(12 + i, 11 + i) = 1.0;
  }
  return closed.eigenvalues().cwiseAbs().maxCoeff();
}

TEST(Linearise, GoesUnstableAtThePredictedStiffness) {
  const auto scenario = nominal_scenario();
  const auto plant = linearise(scenario);
  const auto device = models::phantom_parameters(models::PhantomParameterSet::cavusoglu, 0.052);
  for (const auto axis : models::kAxes) {
    for (const int delay : {0, 1, 2}) {
      control::LoopPlant loop;
      loop.tip_mass_kg = models::phantom_tip_inertia_kg(device, Vector3d::Zero(), axis);
      const double lever = models::phantom_jacobian(device, Vector3d::Zero()).row(models::device_row(axis)).norm();
      loop.tip_damping_Ns_per_m = scenario.device.joint_viscous_Nms_per_rad / (lever * lever);
      loop.arm = models::nominal_arm(axis);
      control::LoopTiming timing;
      timing.delay_samples = delay;
      const double limit = control::critical_stiffness(control::sample_plant(loop, 0.001), timing, 0.0);
      EXPECT_LT(radius(plant, static_cast<int>(axis), 0.99 * limit, delay), 1.0);
      EXPECT_GT(radius(plant, static_cast<int>(axis), 1.01 * limit, delay), 1.0);
    }
  }
}

/// Share of a matrix that is off its diagonal.
double cross_talk(const Eigen::Matrix3d& m) {
  return (m - Eigen::Matrix3d(m.diagonal().asDiagonal())).norm() / m.norm();
}

TEST(Linearise, AxesAreUncoupledAtHomeAndCoupledAwayAsTheMobilitySays) {
  auto scenario = nominal_scenario();
  const auto at_home = linearise(scenario);
  EXPECT_LT(cross_talk(at_home.C * at_home.B), 2e-3);
  const Vector3d q(0.3, 0.6, 0.1);
  scenario.device.pose_rad = {q[0], q[1], q[2]};
  const auto away = linearise(scenario);
  const auto device =
      models::phantom_parameters(models::PhantomParameterSet::cavusoglu, scenario.device.stylus_mass_kg);
  const Eigen::Matrix3d mobility = models::phantom_tip_mobility(device, q);
  Eigen::Matrix3d by_axis;
  for (const auto i : models::kAxes) {
    for (const auto j : models::kAxes) {
      by_axis(static_cast<int>(i), static_cast<int>(j)) = mobility(models::device_row(i), models::device_row(j));
    }
  }
  // one sample of 1 ms: T^2/2 of the mobility, less what the grasp's damping takes in it
  const Eigen::Matrix3d moved = away.C * away.B / 0.5e-6;
  EXPECT_LT((moved - by_axis).norm(), 0.05 * by_axis.norm());
  EXPECT_NEAR(cross_talk(moved) / cross_talk(by_axis), 1.0, 0.1);
  EXPECT_GT(cross_talk(by_axis), 5 * cross_talk(at_home.C * at_home.B));
}

}  // namespace
}  // namespace handloop::sim
