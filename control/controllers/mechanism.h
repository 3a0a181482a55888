#pragma once

#include <Eigen/Core>

namespace handloop::control {

/// Where the tip is and how joint torques reach it, at one pose. Device frame: x fore-aft, y lateral, z up; m, N, Nm,
/// rad.
struct MechanismState {
  Eigen::Vector3d tip_m = Eigen::Vector3d::Zero();
  /// d tip / d q: joint torque = jacobian^T * tip force. Columns of joints that do not exist are zero.
  Eigen::Matrix3d jacobian = Eigen::Matrix3d::Zero();
  /// Joint torque the motors must supply to hold the device still, stylus included.
  Eigen::Vector3d gravity_torque_Nm = Eigen::Vector3d::Zero();
  /// M(q), joint torque = M q'' + ..., rotors and stylus included; zero where it is not known.
  Eigen::Matrix3d mass_matrix_kg_m2 = Eigen::Matrix3d::Zero();
};

/// Kinematics and gravity as a controller knows them: what it computes from joint angles. Immutable.
class Mechanism {
 public:
  virtual ~Mechanism() = default;
  /// Real-time safe: allocates nothing, never throws. Non-finite angles give a non-finite state.
  virtual MechanismState at(const Eigen::Vector3d& joint_rad) const noexcept = 0;
  /// Largest gravity torque each joint ever needs, Nm: a bound on the feed-forward.
  virtual Eigen::Vector3d gravity_bound_Nm() const noexcept = 0;
};

}  // namespace handloop::control
