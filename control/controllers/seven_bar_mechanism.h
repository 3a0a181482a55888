#pragma once

#include "control/controllers/mechanism.h"
#include "models/scenario.h"
#include "models/seven_bar.h"

namespace handloop::control {

/// The seven-bar linkage as its controller knows it. Joints 0 and 1 are th3 and th6; the tip is the handle; x forward,
/// z up (the y of the paper), lateral rows are zero. Both force sensors turn with link 6: their x lies along it.
/// The mass matrix is that of the links: the load's force is measured. The environment's force is the load's, without
/// its weight, brought to the handle by equal virtual work.
class SevenBarMechanism final : public Mechanism {
 public:
  static constexpr double kPeakTorque_Nm = 100.0;  ///< of each motor; ours

  explicit SevenBarMechanism(const models::SevenBarParameters& device);
  MechanismState at(const Eigen::Vector3d& joint_rad) const noexcept override;
  /// Computed torque goes this way: all that the motors have.
  Eigen::Vector3d feedforward_bound_Nm() const noexcept override { return {kPeakTorque_Nm, kPeakTorque_Nm, 0.0}; }
  JointRange joint_range() const noexcept override;
  Eigen::Vector3d hand_force_N(const Eigen::Vector3d& joint_rad,
                               const Eigen::Vector3d& sensed_N) const noexcept override;
  Eigen::Vector3d environment_force_N(const Eigen::Vector3d& joint_rad,
                                      const Eigen::Vector3d& sensed_N) const noexcept override;

 private:
  models::SevenBarParameters device_;
  models::SevenBarInertia inertia_;  ///< with the load, as the computed torque carries it
  models::SevenBarInertia own_;      ///< without its inertia, but with its weight: what the monitor compares
};

/// Lengths and load of a scenario.
models::SevenBarParameters seven_bar_of(const models::Scenario& scenario);

}  // namespace handloop::control
