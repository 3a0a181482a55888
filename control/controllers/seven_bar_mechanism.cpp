#include "control/controllers/seven_bar_mechanism.h"

#include <Eigen/LU>
#include <cmath>

namespace handloop::control {
namespace {

Eigen::Vector3d space(const Eigen::Vector2d& v) {
  return {v[0], 0.0, v[1]};
}

/// From the axes of link 6 to those of the room.
Eigen::Vector2d turned(double th6, const Eigen::Vector3d& sensed_N) {
  const double c = std::cos(th6), s = std::sin(th6);
  return {c * sensed_N[0] - s * sensed_N[2], s * sensed_N[0] + c * sensed_N[2]};
}

models::SevenBarInertia without_load(models::SevenBarParameters device) {
  device.load_kg = 0.0;
  return models::seven_bar_inertia(device);
}

}  // namespace

SevenBarMechanism::SevenBarMechanism(const models::SevenBarParameters& device)
    : device_(device), inertia_(models::seven_bar_inertia(device)), own_(without_load(device)) {}

MechanismState SevenBarMechanism::at(const Eigen::Vector3d& q) const noexcept {
  const Eigen::Vector2d th = q.head<2>();
  const Eigen::Matrix2d jacobian = models::seven_bar_jacobian(device_, th, device_.handle_m);
  MechanismState state;
  state.tip_m = space(models::seven_bar_handle(device_, th));
  state.jacobian.col(0) = space(jacobian.col(0));
  state.jacobian.col(1) = space(jacobian.col(1));
  state.gravity_torque_Nm.head<2>() = models::seven_bar_gravity(inertia_, th);
  state.mass_matrix_kg_m2.topLeftCorner<2, 2>() = models::seven_bar_mass_matrix(own_, th);
  return state;
}

JointRange SevenBarMechanism::joint_range() const noexcept {
  const models::SevenBarStops stops;
  const double inside = 1.5 * stops.switch_inside_rad;  // the software stops before the switches do
  JointRange range;
  for (int i = 0; i < 2; ++i) {
    range.lower_rad[i] = stops.lower_rad[static_cast<std::size_t>(i)] + inside;
    range.upper_rad[i] = stops.upper_rad[static_cast<std::size_t>(i)] - inside;
  }
  range.from = 0;
  range.to = 1;
  range.lower_difference_rad = stops.elbow_lower_rad + inside;
  range.upper_difference_rad = stops.elbow_upper_rad - inside;
  return range;
}

Eigen::Vector3d SevenBarMechanism::hand_force_N(const Eigen::Vector3d& q,
                                                const Eigen::Vector3d& sensed_N) const noexcept {
  return space(turned(q[1], sensed_N));
}

Eigen::Vector3d SevenBarMechanism::environment_force_N(const Eigen::Vector3d& q,
                                                       const Eigen::Vector3d& sensed_N) const noexcept {
  const Eigen::Vector2d weight(0.0, device_.load_kg * device_.gravity_m_per_s2);
  return space(models::seven_bar_load_to_handle(device_, q.head<2>()) * (turned(q[1], sensed_N) - weight));
}

models::SevenBarParameters seven_bar_of(const models::Scenario& scenario) {
  models::SevenBarParameters device;
  device.load_kg = scenario.force_amplifier.load_kg;
  return device;
}

}  // namespace handloop::control
