#pragma once

#include <Eigen/Core>

#include "control/controllers/mechanism.h"
#include "device/device.h"
#include "device/fault.h"
#include "models/scenario.h"

/// Section VI of Kazerooni and Her: "software to monitor the states of the system. The angular positions, velocities
/// and acceleration of the actuators, as well as the contact forces, form the data for this software. If there is a
/// substantial difference between the measured data and the permitted values, the system shuts off." Here against the
/// model as well. It guards every device of the loop; all its faults take the torque away in the same sample.
namespace handloop::device {

/// Permitted values beside the joints' ranges, which the mechanism knows.
struct StateLimits {
  double velocity_rad_per_s = 30.0;
  double acceleration_rad_per_s2 = 6000.0;
  double contact_force_N = 16.0;
  double model_torque_Nm = 0.6;
  bool against_model = true;  ///< false where forces act that no model of a controller knows of
};
StateLimits state_limits(const models::SafetySettings& settings);

/// What one sample knew.
struct JointSample {
  Eigen::Vector3d joint_rad = Eigen::Vector3d::Zero();
  control::MechanismState mechanism;
  Eigen::Vector3d sensed_force_N = Eigen::Vector3d::Zero();       ///< of the device on the hand
  Eigen::Vector3d environment_force_N = Eigen::Vector3d::Zero();  ///< of the device on its environment, at the tip
  Eigen::Vector3d torque_Nm = Eigen::Vector3d::Zero();            ///< asked of the motors since the sample before
};

/// Compares with the model by the generalised momentum p = M q' (De Luca and Mattone 2003): with
/// p' = tau + d(q' M q'/2)/dq - g + J^T f, the residual r = k (p - integral of all that is known and r) is the torque
/// nothing explains through a first-order low-pass of 50 Hz, without a second derivative. Real-time safe.
class StateMonitor {
 public:
  StateMonitor(const StateLimits& limits, const control::Mechanism& mechanism, const DeviceDescription& description);
  void reset() noexcept;
  /// One fresh reading, `samples` periods after the one before. Returns the first fault found, with value and limit.
  FaultEvent check(const JointSample& sample, std::uint64_t samples) noexcept;

  const Eigen::Vector3d& rate_rad_per_s() const noexcept { return rate_; }
  /// What the model does not explain, Nm by joint.
  const Eigen::Vector3d& model_torque_Nm() const noexcept { return residual_; }

 private:
  FaultEvent check_range(const Eigen::Vector3d& q) const noexcept;
  void observe_momentum(const JointSample& sample, double step_s) noexcept;

  StateLimits limits_;
  control::JointRange range_;
  const control::Mechanism& mechanism_;
  Eigen::Index joints_;
  double sample_time_s_;
  bool against_model_;
  bool started_ = false;
  Eigen::Vector3d last_q_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d rate_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d acceleration_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d known_ = Eigen::Vector3d::Zero();  ///< momentum that is explained
  Eigen::Vector3d residual_ = Eigen::Vector3d::Zero();
};

}  // namespace handloop::device
