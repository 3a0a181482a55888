#include "device/state_monitor.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "device/scales.h"

namespace handloop::device {
namespace {

constexpr double kRateCutoff_Hz = 200.0;
constexpr double kAccelerationCutoff_Hz = 100.0;
constexpr double kResidualCutoff_Hz = 50.0;
constexpr double kNudge_rad = 1e-4;

}  // namespace

StateLimits state_limits(const models::SafetySettings& settings) {
  StateLimits limits;
  limits.velocity_rad_per_s = settings.joint_velocity_limit_rad_per_s;
  limits.acceleration_rad_per_s2 = settings.joint_acceleration_limit_rad_per_s2;
  limits.contact_force_N = settings.contact_force_limit_N;
  limits.model_torque_Nm = settings.model_torque_limit_Nm;
  return limits;
}

StateMonitor::StateMonitor(const StateLimits& limits, const control::Mechanism& mechanism,
                           const DeviceDescription& description)
    : limits_(limits),
      range_(mechanism.joint_range()),
      mechanism_(mechanism),
      joints_(static_cast<Eigen::Index>(description.motor_count)),
      sample_time_s_(description.sample_time_s),
      against_model_(limits.against_model && !description.recorded && description.analog_input_count >= 3) {}

void StateMonitor::reset() noexcept {
  started_ = false;
  rate_.setZero();
  acceleration_.setZero();
  residual_.setZero();
}

FaultEvent StateMonitor::check(const JointSample& sample, std::uint64_t samples) noexcept {
  const double step_s = sample_time_s_ * static_cast<double>(std::max<std::uint64_t>(samples, 1));
  if (!started_) last_q_ = sample.joint_rad;
  const double keep = filter_pole(kRateCutoff_Hz, step_s), keep_slow = filter_pole(kAccelerationCutoff_Hz, step_s);
  const Eigen::Vector3d before = rate_;
  rate_ = keep * rate_ + (1.0 - keep) * (sample.joint_rad - last_q_) / step_s;
  acceleration_ = keep_slow * acceleration_ + (1.0 - keep_slow) * (rate_ - before) / step_s;
  last_q_ = sample.joint_rad;
  if (against_model_) observe_momentum(sample, step_s);
  started_ = true;

  if (const auto event = check_range(sample.joint_rad); event.fault != Fault::none) return event;
  if (const double fastest = rate_.cwiseAbs().maxCoeff(); fastest > limits_.velocity_rad_per_s) {
    return found(Fault::joint_velocity, fastest, limits_.velocity_rad_per_s);
  }
  if (const double most = acceleration_.cwiseAbs().maxCoeff(); most > limits_.acceleration_rad_per_s2) {
    return found(Fault::joint_acceleration, most, limits_.acceleration_rad_per_s2);
  }
  if (const double force = std::max(sample.sensed_force_N.norm(), sample.environment_force_N.norm());
      force > limits_.contact_force_N) {
    return found(Fault::contact_force, force, limits_.contact_force_N);
  }
  if (const double torque = residual_.cwiseAbs().maxCoeff(); torque > limits_.model_torque_Nm) {
    return found(Fault::model_mismatch, torque, limits_.model_torque_Nm);
  }
  return {};
}

FaultEvent StateMonitor::check_range(const Eigen::Vector3d& q) const noexcept {
  const auto& range = range_;
  for (Eigen::Index i = 0; i < joints_; ++i) {
    if (q[i] < range.lower_rad[i]) return found(Fault::joint_position, q[i], range.lower_rad[i]);
    if (q[i] > range.upper_rad[i]) return found(Fault::joint_position, q[i], range.upper_rad[i]);
  }
  const double difference = q[range.to] - q[range.from];
  if (difference < range.lower_difference_rad) {
    return found(Fault::joint_position, difference, range.lower_difference_rad);
  }
  if (difference > range.upper_difference_rad) {
    return found(Fault::joint_position, difference, range.upper_difference_rad);
  }
  return {};
}

void StateMonitor::observe_momentum(const JointSample& sample, double step_s) noexcept {
  const Eigen::Vector3d momentum = sample.mechanism.mass_matrix_kg_m2 * rate_;
  if (!started_) known_ = momentum;
  Eigen::Vector3d torque = sample.torque_Nm - sample.mechanism.gravity_torque_Nm -
                           sample.mechanism.jacobian.transpose() * (sample.sensed_force_N + sample.environment_force_N);
  for (Eigen::Index i = 0; i < joints_; ++i) {
    Eigen::Vector3d aside = sample.joint_rad;
    aside[i] += kNudge_rad;
    const double above = rate_.dot(mechanism_.at(aside).mass_matrix_kg_m2 * rate_);
    aside[i] -= 2.0 * kNudge_rad;
    torque[i] += (above - rate_.dot(mechanism_.at(aside).mass_matrix_kg_m2 * rate_)) / (4.0 * kNudge_rad);
  }
  known_ += step_s * (torque + residual_);
  residual_ = 2.0 * std::numbers::pi * kResidualCutoff_Hz * (momentum - known_);
  for (Eigen::Index i = joints_; i < 3; ++i) residual_[i] = 0.0;
}

}  // namespace handloop::device
