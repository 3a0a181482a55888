#include "sim/linearise.h"

#include <array>

#include "sim/phantom_dynamics.h"

namespace handloop::sim {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using State = Eigen::Matrix<double, 12, 1>;

constexpr double kNudge = 1e-5;  ///< rad, m, rad/s, m/s or N: far above rounding, far below any curvature

/// At rest, unheld or held, without what a linear plant cannot have.
models::Scenario at_rest(models::Scenario scenario) {
  scenario.device.joint_coulomb_Nm = 0.0;
  scenario.device.structural_frequency_Hz = 0.0;
  scenario.hand.push_N = scenario.hand.disturbance_N = 0.0;
  scenario.arm.wander_rms_m = 0.0;
  return scenario;
}

/// Rows of the Jacobian in the order of the arm's axes.
Matrix3d by_axis(const Matrix3d& device_frame) {
  Matrix3d rows;
  for (const auto axis : models::kAxes) rows.row(static_cast<int>(axis)) = device_frame.row(models::device_row(axis));
  return rows;
}

State state_of(const PhantomDynamics& dynamics) {
  State z;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    z[row] = dynamics.motor_side_rad(i);
    z[3 + row] = dynamics.motor_side_rad_per_s(i);
    const auto& arm = dynamics.arm(models::kAxes[i]);
    z[6 + 2 * row] = arm.position_m();
    z[7 + 2 * row] = arm.velocity_m_per_s();
  }
  return z;
}

}  // namespace

Matrix3d tip_mobility(const models::Scenario& scenario) {
  auto free = at_rest(scenario);
  free.arm.attached = false;
  free.arm.effects.clear();
  PhantomDynamics dynamics(free, false);
  const auto tip = dynamics.tip();
  const auto acceleration = [&](const Vector3d& pull_N) {
    PhantomDynamics::Reaction reaction;
    reaction.force_N = -pull_N;
    return dynamics.tip_acceleration(tip, reaction);
  };
  const Vector3d falling = acceleration(Vector3d::Zero());
  Matrix3d mobility;
  for (int i = 0; i < 3; ++i) mobility.col(i) = acceleration(Vector3d::Unit(i)) - falling;
  return mobility;
}

LinearisedPlant linearise(const models::Scenario& scenario) {
  const auto quiet = at_rest(scenario);
  PhantomDynamics dynamics(quiet, false);
  const Matrix3d jacobian = by_axis(dynamics.tip().jacobian);
  // motors carry the weight: the torques under which the unheld device does not accelerate
  const Vector3d carried = dynamics.holding_torque_Nm();
  const State rest = state_of(dynamics);
  const auto sample_from = [&](const State& z, const Vector3d& force_N) {
    dynamics.reset();
    dynamics.place(z.segment<3>(0), z.segment<3>(3));
    for (std::size_t i = 0; i < 3; ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      dynamics.place_arm(models::kAxes[i], z[6 + 2 * row], z[7 + 2 * row]);
    }
    dynamics.advance(0, carried + jacobian.transpose() * force_N);
    return state_of(dynamics);
  };
  LinearisedPlant plant;
  plant.sample_time_s = scenario.loop.sample_time_s;
  for (Eigen::Index i = 0; i < 12; ++i) {
    const State nudge = kNudge * State::Unit(i);
    plant.A.col(i) =
        (sample_from(rest + nudge, Vector3d::Zero()) - sample_from(rest - nudge, Vector3d::Zero())) / (2 * kNudge);
  }
  for (Eigen::Index i = 0; i < 3; ++i) {
    const Vector3d push = kNudge * Vector3d::Unit(i);
    plant.B.col(i) = (sample_from(rest, push) - sample_from(rest, -push)) / (2 * kNudge);
  }
  plant.C.setZero();
  plant.C.leftCols<3>() = jacobian;
  return plant;
}

}  // namespace handloop::sim
