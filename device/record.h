#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "device/device.h"
#include "device/fault.h"

namespace handloop::device {

/// Everything one pass of the loop knew and did. Device frame, SI; a plain value, fit for ring buffers.
struct StepRecord {
  std::uint64_t step = 0;  ///< passes of the loop before this one
  Reading reading;
  Command command;  ///< written in this pass
  Eigen::Vector3d joint_rad = Eigen::Vector3d::Zero();
  Eigen::Vector3d tip_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity_m_per_s = Eigen::Vector3d::Zero();     ///< of the tip, filtered
  Eigen::Vector3d sensed_force_N = Eigen::Vector3d::Zero();       ///< of the device on the hand, from the sensor
  Eigen::Vector3d environment_force_N = Eigen::Vector3d::Zero();  ///< of the device on its environment, at the tip
  double grip_force_N = 0.0;
  Eigen::Vector3d wanted_force_N = Eigen::Vector3d::Zero();   ///< the controller's, computed in this pass
  Eigen::Vector3d limited_force_N = Eigen::Vector3d::Zero();  ///< after the envelope
  Eigen::Vector3d written_force_N = Eigen::Vector3d::Zero();  ///< that acts until the next pass (delayed)
  Eigen::Vector3d model_torque_Nm = Eigen::Vector3d::Zero();  ///< by joint, that the mechanism's model does not explain
  double energy_J = 0.0;                                      ///< given to the hand less received (passivity observer)
  bool in_contact = false;
  bool clipped = false;  ///< the envelope changed the controller's force
  bool command_taken = false;
  Fault fault = Fault::none;    ///< latched
  std::int64_t compute_ns = 0;  ///< this pass without the device's own time
};

}  // namespace handloop::device
