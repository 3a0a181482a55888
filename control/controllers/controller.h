#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "control/controllers/mechanism.h"

namespace handloop::control {

/// What a controller is told each sample. Device frame, SI.
struct ControllerInput {
  std::uint64_t sample = 0;
  double time_s = 0.0;
  Eigen::Vector3d joint_rad = Eigen::Vector3d::Zero();
  MechanismState mechanism;                                       ///< at joint_rad
  Eigen::Vector3d sensed_force_N = Eigen::Vector3d::Zero();       ///< of the device on the hand, from the sensor
  Eigen::Vector3d environment_force_N = Eigen::Vector3d::Zero();  ///< of the device on its environment, at the tip
  double grip_force_N = 0.0;
};

/// What it asks for: a force on the hand at the tip, and joint torques beside it that the hand should not feel.
struct ControllerOutput {
  Eigen::Vector3d force_N = Eigen::Vector3d::Zero();                ///< subject to the safety envelope
  Eigen::Vector3d feedforward_torque_Nm = Eigen::Vector3d::Zero();  ///< bounded by the mechanism's own need
  bool in_contact = false;
};

/// A controller is a pure function of its past inputs: no clock, no device, no randomness.
class Controller {
 public:
  virtual ~Controller() = default;
  /// Back to the state of a first sample.
  virtual void reset() noexcept = 0;
  /// Real-time safe: must not allocate, lock or format. Should not throw; the loop latches a fault where it does.
  virtual ControllerOutput step(const ControllerInput& input) = 0;
};

}  // namespace handloop::control
