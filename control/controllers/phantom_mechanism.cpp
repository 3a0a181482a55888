#include "control/controllers/phantom_mechanism.h"

#include <cmath>
#include <numbers>

#include "models/errors.h"

namespace handloop::control {
namespace {

constexpr double kBoundMargin = 1.1;

}  // namespace

PhantomMechanism::PhantomMechanism(const models::PhantomParameters& lengths, const models::PhantomParameters& masses,
                                   bool counterbalanced)
    : lengths_(lengths), masses_(masses), counterbalanced_(counterbalanced) {
  // Gravity of joint 2 goes with cos q2 and of joint 3 with sin q3: their amplitudes are the bound.
  const auto upright = at({0.0, 0.0, 0.0}).gravity_torque_Nm;
  const auto level = at({0.0, 0.0, std::numbers::pi / 2}).gravity_torque_Nm;
  bound_ = kBoundMargin * upright.cwiseAbs().cwiseMax(level.cwiseAbs());
}

MechanismState PhantomMechanism::at(const Eigen::Vector3d& joint_rad) const noexcept {
  MechanismState state;
  state.tip_m = models::phantom_tip(lengths_, joint_rad);
  state.jacobian = models::phantom_jacobian(lengths_, joint_rad);
  state.gravity_torque_Nm = models::phantom_gravity(masses_, joint_rad);
  state.mass_matrix_kg_m2 = models::phantom_mass_matrix(masses_, joint_rad);
  if (counterbalanced_) {
    state.gravity_torque_Nm[1] -=
        masses_.tip_mass_kg * masses_.gravity_m_per_s2 * masses_.l1_m * std::cos(joint_rad[1]);
  }
  return state;
}

JointRange PhantomMechanism::joint_range() const noexcept {
  const auto limits = models::phantom_limits();
  JointRange range;
  range.lower_rad = {limits.lower_rad[0], limits.lower_rad[1], limits.lower_rad[2]};
  range.upper_rad = {limits.upper_rad[0], limits.upper_rad[1], limits.upper_rad[2]};
  range.from = 1;
  range.to = 2;
  range.lower_difference_rad = limits.lower_difference_rad;
  range.upper_difference_rad = limits.upper_difference_rad;
  return range;
}

std::unique_ptr<Mechanism> make_mechanism(const models::DeviceSettings& device) {
  if (device.model != models::DeviceModel::phantom_premium_1_5) {
    throw InputError("device.model: this needs phantom_premium_1_5; a seven-bar linkage goes with run and margins");
  }
  return std::make_unique<PhantomMechanism>(
      models::phantom_parameters(device.parameter_set, device.stylus_mass_kg),
      models::phantom_parameters(models::PhantomParameterSet::cavusoglu, device.stylus_mass_kg),
      device.counterbalanced);
}

}  // namespace handloop::control
