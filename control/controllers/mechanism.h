#pragma once

#include <Eigen/Core>
#include <limits>

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

/// Permitted joint angles, rad, and of the difference joint[to] - joint[from] (a parallelogram's own limit).
struct JointRange {
  static constexpr double kAny = std::numeric_limits<double>::infinity();
  Eigen::Vector3d lower_rad = Eigen::Vector3d::Constant(-kAny), upper_rad = Eigen::Vector3d::Constant(kAny);
  int from = 0, to = 0;
  double lower_difference_rad = -kAny, upper_difference_rad = kAny;
};

/// Kinematics and gravity as a controller knows them: what it computes from joint angles. Immutable.
class Mechanism {
 public:
  virtual ~Mechanism() = default;
  /// Real-time safe: allocates nothing, never throws. Non-finite angles give a non-finite state.
  virtual MechanismState at(const Eigen::Vector3d& joint_rad) const noexcept = 0;
  /// Largest torque beside that of the tip force each joint may ever be asked for, Nm.
  virtual Eigen::Vector3d feedforward_bound_Nm() const noexcept = 0;
  /// Where the joints may be.
  virtual JointRange joint_range() const noexcept { return {}; }
  /// Force of the device on the hand in the device frame, N, from what the sensor says along its own axes.
  virtual Eigen::Vector3d hand_force_N(const Eigen::Vector3d&, const Eigen::Vector3d& sensed_N) const noexcept {
    return sensed_N;
  }
  /// Force of the device on its environment as it counts at the tip, N, the weight of the load left out; zero for a
  /// device without an environment sensor.
  virtual Eigen::Vector3d environment_force_N(const Eigen::Vector3d&, const Eigen::Vector3d& sensed_N) const noexcept {
    return sensed_N;
  }
};

}  // namespace handloop::control
