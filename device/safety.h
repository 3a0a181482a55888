#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>

#include "control/controllers/mechanism.h"
#include "device/device.h"
#include "device/encoder_watch.h"
#include "device/fault.h"
#include "models/scenario.h"

/// The envelope within which the loop lets force reach a hand. Everything here is real-time safe.
namespace handloop::device {

/// Limits in SI at the tip; those of a scenario and a few that follow from the device.
struct SafetyLimits {
  double force_N = 5.0;  ///< norm of the force asked of the motors
  double force_rate_N_per_s = 5000.0;
  double velocity_m_per_s = 2.0;
  double acceleration_m_per_s2 = 400.0;
  double workspace_radius_m = 0.15;  ///< about `home_tip_m`
  double energy_J = 0.5;             ///< that the wall may give beyond what it received
  int watchdog_samples = 20;
  double ramp_s = 0.05;
  double stuck_force_N = 2.0;     ///< change of sensed force that must move an encoder
  double mismatch_force_N = 2.0;  ///< between sensed and asked force, both below 2 Hz
  bool watch_encoders = true;     ///< by the forces: see EncoderWatch
  double least_momentum_Ns = EncoderWatch::kLeast_Ns;
  Eigen::Vector3d home_tip_m = Eigen::Vector3d::Zero();
};

/// Those of a scenario. The counters are not watched where it adds effects to joint, actuator or sensor: forces its
/// controller does not know of.
SafetyLimits safety_limits(const models::Scenario& scenario, const Eigen::Vector3d& home_tip_m);

/// Clips a wanted force: its norm to the limit, its change from the last one to the rate. Keeps the direction of each.
class ForceLimiter {
 public:
  ForceLimiter(const SafetyLimits& limits, double sample_time_s);
  void reset() noexcept { last_N_.setZero(); }
  /// `clipped` tells whether the force was changed. The wanted force must be finite.
  Eigen::Vector3d limit(const Eigen::Vector3d& wanted_N, bool& clipped) noexcept;

 private:
  double limit_N_;
  double step_N_;
  Eigen::Vector3d last_N_ = Eigen::Vector3d::Zero();
};

/// Passivity observer (Hannaford and Ryu 2002): E[n] = E[n-1] + f[n-1] . (x[n] - x[n-1]), the force held since the last
/// sample times the way the tip went. Positive: the wall gave more than it took. What it took is credited while contact
/// lasts, up to twice the limit; out of contact the credit ends and a surplus fades with a time constant of 1 s, so
/// that a chattering wall is found as well.
class PassivityObserver {
 public:
  PassivityObserver(double limit_J, double sample_time_s);
  void reset() noexcept { energy_J_ = 0.0; }
  double update(const Eigen::Vector3d& held_force_N, const Eigen::Vector3d& tip_step_m, bool in_contact) noexcept;
  double energy_J() const noexcept { return energy_J_; }

 private:
  double credit_J_;
  double fade_;
  double energy_J_ = 0.0;
};

/// Watches what the device says for things that cannot be or must not go on.
class MotionMonitor {
 public:
  MotionMonitor(const SafetyLimits& limits, const DeviceDescription& description);
  void reset() noexcept;

  /// One fresh reading, `samples` periods after the one before. Returns the first fault found, with value and limit.
  /// `held_force_N` is the force the motors were asked for since.
  FaultEvent check(const Reading& reading, const control::MechanismState& state, const Eigen::Vector3d& sensed_N,
                   const Eigen::Vector3d& held_force_N, std::uint64_t samples) noexcept;
  /// Tip velocity through a 100 Hz first-order low-pass.
  const Eigen::Vector3d& velocity_m_per_s() const noexcept { return velocity_; }
  bool any_force_input_at_end() const noexcept;

 private:
  FaultEvent check_motion(const control::MechanismState& state, std::uint64_t samples) noexcept;
  FaultEvent check_sensors(const Reading& reading, double tip_step_m) noexcept;
  FaultEvent check_encoders(const Reading& reading, const control::MechanismState& state,
                            const Eigen::Vector3d& sensed_N) noexcept;
  FaultEvent check_forces(const Eigen::Vector3d& sensed_N, const Eigen::Vector3d& held_force_N) noexcept;

  SafetyLimits limits_;
  DeviceDescription description_;
  double sample_time_s_;
  double velocity_pole_;
  double acceleration_pole_;
  double mismatch_pole_;
  bool started_ = false;
  Eigen::Vector3d last_tip_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d acceleration_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d mismatch_N_ = Eigen::Vector3d::Zero();

  struct Channel {
    std::uint32_t code = 0;
    int at_end = 0;      ///< samples at the end of the range
    int unchanged = 0;   ///< samples at one code
    double way_m = 0.0;  ///< the tip's way meanwhile
  };
  std::array<Channel, kMaxAnalogInputs> channels_{};

  struct Encoder {
    std::int32_t counts = 0;
    double lowest_N = 0.0, highest_N = 0.0;  ///< sensed force along the joint since the count last changed
    int unchanged = 0;
  };
  std::array<Encoder, kMaxMotors> encoders_{};
};

}  // namespace handloop::device
