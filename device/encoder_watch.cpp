#include "device/encoder_watch.h"

#include <cmath>
#include <numbers>

#include "device/scales.h"

namespace handloop::device {
namespace {

constexpr double kHighPass_Hz = 1.0;
constexpr double kLowPass_Hz = 20.0;
constexpr double kMemory_s = 0.25;
constexpr double kPatience_s = 0.1;
constexpr double kLeastLever_m = 1e-3;

}  // namespace

EncoderWatch::EncoderWatch(std::size_t motor_count, double sample_time_s, double least_momentum_Ns)
    : motor_count_(motor_count),
      sample_time_s_(sample_time_s),
      least_Ns_(least_momentum_Ns),
      high_pass_(filter_pole(kHighPass_Hz, sample_time_s)),
      low_pass_(filter_pole(kLowPass_Hz, sample_time_s)),
      forget_(-std::expm1(-sample_time_s / kMemory_s)),
      patience_(static_cast<int>(std::lround(kPatience_s / sample_time_s))) {}

void EncoderWatch::reset() noexcept {
  started_ = false;
  joints_ = {};
}

double EncoderWatch::pass(Band& band, double increment) const noexcept {
  const double before = band.once;
  band.once = high_pass_ * (band.once + increment);
  band.twice = high_pass_ * (band.twice + band.once - before);
  band.out = low_pass_ * band.out + (1.0 - low_pass_) * band.twice;
  return band.out;
}

FaultEvent EncoderWatch::check(const Eigen::Vector3d& joint_rad, const control::MechanismState& state,
                               const Eigen::Vector3d& motor_torque_Nm, const Eigen::Vector3d& sensed_N,
                               std::uint64_t samples) noexcept {
  const Eigen::Vector3d step_rad = started_ ? Eigen::Vector3d(joint_rad - last_rad_) : Eigen::Vector3d::Zero();
  last_rad_ = joint_rad;
  started_ = true;
  const double periods = static_cast<double>(samples);
  const Eigen::Vector3d momentum = state.mass_matrix_kg_m2 * step_rad / (sample_time_s_ * periods);
  const Eigen::Vector3d to_hand_Nm = state.jacobian.transpose() * sensed_N;
  FaultEvent event;
  for (std::size_t i = 0; i < motor_count_; ++i) {
    Joint& joint = joints_[i];
    const auto row = static_cast<Eigen::Index>(i);
    const double lever_m = state.jacobian.col(row).norm();
    if (!(lever_m > kLeastLever_m) || !(state.mass_matrix_kg_m2(row, row) > 0.0)) continue;
    const double passed_on_Ns = to_hand_Nm[row] / lever_m * sample_time_s_;
    const double given_Ns =
        (motor_torque_Nm[row] - state.gravity_torque_Nm[row]) / lever_m * sample_time_s_ - passed_on_Ns;
    const double shown_Ns = (momentum[row] / lever_m - joint.momentum_Ns) / periods;
    joint.momentum_Ns = momentum[row] / lever_m;
    for (std::uint64_t k = 0; k < samples; ++k) {
      const double by_forces = pass(joint.by_forces, given_Ns);
      const double by_counter = pass(joint.by_counter, shown_Ns);
      const double passed_on = pass(joint.passed_on, passed_on_Ns);
      joint.forces_squared += forget_ * (by_forces * by_forces - joint.forces_squared);
      joint.both += forget_ * (by_forces * by_counter - joint.both);
      joint.passed_on_squared += forget_ * (passed_on * passed_on - joint.passed_on_squared);
      const double least_Ns = least_Ns_ + kLeastShare * std::sqrt(joint.passed_on_squared);
      const bool contradicts =
          joint.forces_squared > least_Ns * least_Ns && joint.both < kLeastGain * joint.forces_squared;
      joint.against = contradicts ? joint.against + 1 : 0;
    }
    if (joint.against > patience_ && event.fault == Fault::none) {
      event = {Fault::encoder_disagrees, 0, 0, joint.both / joint.forces_squared, kLeastGain};
    }
  }
  return event;
}

}  // namespace handloop::device
