#pragma once

#include <Eigen/Core>
#include <array>

#include "control/controllers/mechanism.h"
#include "device/device.h"
#include "device/fault.h"

/// Does a counter tell what the forces say? Real-time safe.
namespace handloop::device {

/// Compares, joint by joint, the momentum the forces give the device with the momentum its counters show: a counter
/// that stops, counts backwards or belongs to another joint is found although its joint is free, where no force stands
/// out.
///
/// The generalised momentum p = M(q) q' obeys p' = tau - N(q) - J^T f, with the motors' torque tau, gravity N and the
/// force f of the device on the hand (De Luca and Mattone, ICRA 2003, whose residual this is, Coriolis terms left out).
/// Both sides pass the same band, 1 to 20 Hz: below lie offsets of the sensor and of gravity, above quantisation.
/// Regressed over the last quarter of a second, counter on forces, a good counter gives about 1, one that stopped 0 and
/// one that counts backwards -1. A gain below `kLeastGain` for 0.1 s is the fault.
///
/// It can only be seen where there is momentum to see: `least_momentum_Ns` at the tip, above friction's part (0.04 N at
/// 2 Hz is 3 mNs), and a share of the force passed on, above errors of torque constants and sensor. Some 0.1 m/s at 0.1
/// kg.
class EncoderWatch {
 public:
  static constexpr double kLeast_Ns = 0.01;
  static constexpr double kLeastShare = 0.15;
  static constexpr double kLeastGain = 0.25;

  EncoderWatch(std::size_t motor_count, double sample_time_s, double least_momentum_Ns = kLeast_Ns);
  void reset() noexcept;

  /// One fresh reading, `samples` periods after the one before; torque and force held since then, device frame.
  /// Event encoder_disagrees carries the gain found.
  FaultEvent check(const Eigen::Vector3d& joint_rad, const control::MechanismState& state,
                   const Eigen::Vector3d& motor_torque_Nm, const Eigen::Vector3d& sensed_N,
                   std::uint64_t samples) noexcept;

 private:
  /// High-pass twice at 1 Hz, low-pass at 20 Hz, of a quantity given by its increments.
  struct Band {
    double once = 0.0, twice = 0.0, out = 0.0;
  };
  double pass(Band& band, double increment) const noexcept;

  struct Joint {
    double momentum_Ns = 0.0;  ///< the counter's, before the band
    Band by_forces, by_counter, passed_on;
    double forces_squared = 0.0, both = 0.0, passed_on_squared = 0.0;  ///< means over the last quarter of a second
    int against = 0;                                                   ///< samples in a row that contradict
  };

  std::size_t motor_count_;
  double sample_time_s_;
  double least_Ns_;
  double high_pass_, low_pass_, forget_;
  int patience_;
  bool started_ = false;
  Eigen::Vector3d last_rad_ = Eigen::Vector3d::Zero();
  std::array<Joint, kMaxMotors> joints_{};
};

}  // namespace handloop::device
