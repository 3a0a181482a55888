#include "device/safety.h"

#include <algorithm>
#include <cmath>

#include "device/scales.h"

namespace handloop::device {
namespace {

constexpr double kVelocityCutoff_Hz = 100.0;
// One encoder count a sample is 30 m/s^2 in plain differences: acceleration is only meaningful well below the rate.
constexpr double kAccelerationCutoff_Hz = 30.0;
// Above this the inertia of the device stands between motors and sensor.
constexpr double kMismatchCutoff_Hz = 2.0;
// Dry friction F reversing at 1 Hz leaves an impulse of 0.07 F s rms in the band of EncoderWatch.
constexpr double kFrictionImpulse_s = 0.1;
constexpr double kShortestLever_m = 0.14;
constexpr int kSaturatedSamples = 20;
constexpr int kDeadSamples = 500;
constexpr double kDeadWay_m = 2e-3;
constexpr int kStuckSamples = 50;
// A jump is a way no motion within the limit could make, with room for coarse encoders.
constexpr double kJumpFactor = 1.5;
constexpr double kJumpRoom_m = 2e-4;

}  // namespace

SafetyLimits safety_limits(const models::Scenario& scenario, const Eigen::Vector3d& home_tip_m) {
  const models::SafetySettings& settings = scenario.safety;
  SafetyLimits limits;
  limits.force_N = settings.force_limit_N;
  limits.force_rate_N_per_s = settings.force_rate_limit_N_per_s;
  limits.velocity_m_per_s = settings.velocity_limit_m_per_s;
  limits.acceleration_m_per_s2 = settings.acceleration_limit_m_per_s2;
  limits.workspace_radius_m = settings.workspace_radius_m;
  limits.energy_J = settings.energy_limit_J;
  limits.watchdog_samples = settings.watchdog_samples;
  limits.watch_encoders =
      std::none_of(scenario.arm.effects.begin(), scenario.arm.effects.end(), [](const auto& axis_and_effect) {
        const auto place = axis_and_effect.second->place();
        return place != models::Place::arm && place != models::Place::grasp;
      });
  limits.least_momentum_Ns += kFrictionImpulse_s * scenario.device.joint_coulomb_Nm / kShortestLever_m;
  limits.home_tip_m = home_tip_m;
  return limits;
}

ForceLimiter::ForceLimiter(const SafetyLimits& limits, double sample_time_s)
    : limit_N_(limits.force_N), step_N_(limits.force_rate_N_per_s * sample_time_s) {}

Eigen::Vector3d ForceLimiter::limit(const Eigen::Vector3d& wanted_N, bool& clipped) noexcept {
  clipped = false;
  Eigen::Vector3d force = wanted_N;
  if (const double norm = force.norm(); norm > limit_N_) {
    force *= limit_N_ / norm;
    clipped = true;
  }
  const Eigen::Vector3d step = force - last_N_;
  if (const double norm = step.norm(); norm > step_N_) {
    force = last_N_ + step * (step_N_ / norm);
    clipped = true;
  }
  last_N_ = force;
  return force;
}

PassivityObserver::PassivityObserver(double limit_J, double sample_time_s)
    : credit_J_(2.0 * limit_J), fade_(std::exp(-sample_time_s)) {}

double PassivityObserver::update(const Eigen::Vector3d& held_force_N, const Eigen::Vector3d& tip_step_m,
                                 bool in_contact) noexcept {
  energy_J_ = std::max(energy_J_ + held_force_N.dot(tip_step_m), -credit_J_);
  if (!in_contact) energy_J_ = std::max(energy_J_, 0.0) * fade_;
  return energy_J_;
}

MotionMonitor::MotionMonitor(const SafetyLimits& limits, const DeviceDescription& description)
    : limits_(limits),
      description_(description),
      sample_time_s_(description.sample_time_s),
      velocity_pole_(filter_pole(kVelocityCutoff_Hz, description.sample_time_s)),
      acceleration_pole_(filter_pole(kAccelerationCutoff_Hz, description.sample_time_s)),
      mismatch_pole_(filter_pole(kMismatchCutoff_Hz, description.sample_time_s)) {}

void MotionMonitor::reset() noexcept {
  started_ = false;
  velocity_.setZero();
  acceleration_.setZero();
  mismatch_N_.setZero();
  channels_ = {};
  encoders_ = {};
}

FaultEvent MotionMonitor::check(const Reading& reading, const control::MechanismState& state,
                                const Eigen::Vector3d& sensed_N, const Eigen::Vector3d& held_force_N,
                                std::uint64_t samples) noexcept {
  if (!started_) {
    last_tip_ = state.tip_m;
    for (std::size_t i = 0; i < kMaxMotors; ++i) encoders_[i].counts = reading.encoder_counts[i];
    for (std::size_t i = 0; i < kMaxAnalogInputs; ++i) channels_[i].code = reading.adc_codes[i];
    started_ = true;
  }
  const double way_m = (state.tip_m - last_tip_).norm();
  FaultEvent event = check_motion(state, std::max<std::uint64_t>(samples, 1));
  if (event.fault == Fault::none) event = check_sensors(reading, way_m);
  if (event.fault == Fault::none) event = check_encoders(reading, state, sensed_N);
  if (event.fault == Fault::none) event = check_forces(sensed_N, held_force_N);
  last_tip_ = state.tip_m;
  return event;
}

FaultEvent MotionMonitor::check_motion(const control::MechanismState& state, std::uint64_t samples) noexcept {
  const double periods = static_cast<double>(samples);
  const Eigen::Vector3d step = state.tip_m - last_tip_;
  const double farthest_m = kJumpFactor * limits_.velocity_m_per_s * sample_time_s_ * periods + kJumpRoom_m;
  if (step.norm() > farthest_m) return found(Fault::encoder_jump, step.norm(), farthest_m);

  // After a gap the mean velocity over it counts for each of its samples.
  const Eigen::Vector3d mean_velocity = step / (sample_time_s_ * periods);
  const double keep = std::pow(velocity_pole_, periods);
  const Eigen::Vector3d before = velocity_;
  velocity_ = keep * velocity_ + (1.0 - keep) * mean_velocity;
  const double keep_acceleration = std::pow(acceleration_pole_, periods);
  acceleration_ =
      keep_acceleration * acceleration_ + (1.0 - keep_acceleration) * (velocity_ - before) / (sample_time_s_ * periods);

  if (velocity_.norm() > limits_.velocity_m_per_s) {
    return found(Fault::velocity, velocity_.norm(), limits_.velocity_m_per_s);
  }
  if (acceleration_.norm() > limits_.acceleration_m_per_s2) {
    return found(Fault::acceleration, acceleration_.norm(), limits_.acceleration_m_per_s2);
  }
  const double away_m = (state.tip_m - limits_.home_tip_m).norm();
  if (away_m > limits_.workspace_radius_m) return found(Fault::workspace, away_m, limits_.workspace_radius_m);
  return {};
}

FaultEvent MotionMonitor::check_sensors(const Reading& reading, double tip_step_m) noexcept {
  const auto top = static_cast<std::uint32_t>(std::ldexp(1.0, description_.adc_bits) - 1.0);
  for (std::size_t i = 0; i < description_.analog_input_count; ++i) {
    Channel& channel = channels_[i];
    const std::uint32_t code = reading.adc_codes[i];
    channel.at_end = code == 0 || code >= top ? channel.at_end + 1 : 0;
    if (channel.at_end > kSaturatedSamples) return found(Fault::sensor_saturated, channel.at_end, kSaturatedSamples);
    // Only the force channels are fast enough to change with every sample; the grip channel is held between its
    // own.
    if (description_.ideal || i >= force_inputs(description_)) continue;
    if (code != channel.code) {
      channel.code = code;
      channel.unchanged = 0;
      channel.way_m = 0.0;
    } else {
      ++channel.unchanged;
      channel.way_m += tip_step_m;
    }
    if (channel.unchanged > kDeadSamples && channel.way_m > kDeadWay_m) {
      return found(Fault::sensor_dead, channel.unchanged, kDeadSamples);
    }
  }
  return {};
}

bool MotionMonitor::any_force_input_at_end() const noexcept {
  return std::any_of(channels_.begin(), channels_.begin() + static_cast<std::ptrdiff_t>(force_inputs(description_)),
                     [](const Channel& channel) { return channel.at_end > 0; });
}

FaultEvent MotionMonitor::check_encoders(const Reading& reading, const control::MechanismState& state,
                                         const Eigen::Vector3d& sensed_N) noexcept {
  const bool sensor_at_end = any_force_input_at_end();
  for (std::size_t i = 0; i < description_.motor_count; ++i) {
    Encoder& encoder = encoders_[i];
    const auto column = state.jacobian.col(static_cast<Eigen::Index>(i));
    const double lever_m = column.norm();
    if (!(lever_m > 1e-3)) continue;
    const double along_N = column.dot(sensed_N) / lever_m;
    // A sensor at the end of its range says nothing about force.
    if (sensor_at_end || encoder.unchanged == 0 || reading.encoder_counts[i] != encoder.counts) {
      encoder = {reading.encoder_counts[i], along_N, along_N, 1};
      continue;
    }
    ++encoder.unchanged;
    encoder.lowest_N = std::min(encoder.lowest_N, along_N);
    encoder.highest_N = std::max(encoder.highest_N, along_N);
    const double change_N = encoder.highest_N - encoder.lowest_N;
    if (encoder.unchanged > kStuckSamples && change_N > limits_.stuck_force_N) {
      return found(Fault::encoder_stuck, change_N, limits_.stuck_force_N);
    }
  }
  return {};
}

FaultEvent MotionMonitor::check_forces(const Eigen::Vector3d& sensed_N, const Eigen::Vector3d& held_force_N) noexcept {
  if (description_.analog_input_count < 3 || any_force_input_at_end()) {
    return {};
  }
  mismatch_N_ = mismatch_pole_ * mismatch_N_ + (1.0 - mismatch_pole_) * (sensed_N - held_force_N);
  if (mismatch_N_.norm() > limits_.mismatch_force_N) {
    return found(Fault::force_mismatch, mismatch_N_.norm(), limits_.mismatch_force_N);
  }
  return {};
}

}  // namespace handloop::device
