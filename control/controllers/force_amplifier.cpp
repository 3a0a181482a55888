#include "control/controllers/force_amplifier.h"

#include <Eigen/LU>
#include <cmath>
#include <numbers>

#include "control/controllers/seven_bar_mechanism.h"
#include "models/errors.h"

namespace handloop::control {
namespace {

using Eigen::Vector2d;

constexpr double kHold_rad_per_s = 30.0;  ///< how fast the reference comes to rest where the hand let go
constexpr double kGripBounce_s = 0.01;    ///< a grip counts as lost, or taken, after this
constexpr double kSingular = 1e-4;        ///< m^2: below this the arm is stretched and the monitor's to stop

Vector2d plane(const Eigen::Vector3d& v) {
  return {v[0], v[2]};
}

std::vector<double> list(const models::Cubic& c) {
  return trimmed({c.begin(), c.end()});
}

}  // namespace

ForceAmplifier::ForceAmplifier(const Settings& settings)
    : settings_(settings),
      inertia_(models::seven_bar_inertia(settings.device)),
      origin_m_(models::seven_bar_handle(settings.device, settings.home_rad)),
      velocity_pole_(std::exp(-2.0 * std::numbers::pi * kVelocityCutoff_Hz * settings.sample_time_s)) {
  if (!(settings.sample_time_s > 0.0) || !(settings.bandwidth_rad_per_s > 0.0)) {
    throw InputError("force amplifier: sample time and bandwidth must be positive");
  }
  for (std::size_t i = 0; i < 2; ++i) {
    environment_filter_[i] = DiscreteFilter(settings.K, settings.sample_time_s);
    for (std::size_t k = 0; k < 2; ++k) {
      hand_filter_[i][k] = DiscreteFilter(settings.K * settings.alpha.entries[i][k], settings.sample_time_s);
    }
  }
  const auto& g = settings.primary;
  Eigen::Matrix3d A;
  A << 0, 1, 0, 0, 0, 1, -g.d0 / g.d3, -g.d1 / g.d3, -1.0 / g.d3;
  const Eigen::Matrix3d half = 0.5 * settings.sample_time_s * A;
  const Eigen::Matrix3d back = (Eigen::Matrix3d::Identity() - half).inverse();
  advance_ = back * (Eigen::Matrix3d::Identity() + half);
  take_ = back * Eigen::Vector3d(0, 0, 0.5 * settings.sample_time_s / g.d3);
  reset();
}

void ForceAmplifier::reset() noexcept {
  for (auto& filter : environment_filter_) filter.reset();
  for (auto& row : hand_filter_) {
    for (auto& filter : row) filter.reset();
  }
  states_.setZero();
  last_desired_m_.setZero();
  offset_m_.setZero();
  desired_m_.setZero();
  error_rate_m_per_s_.setZero();
  rate_rad_per_s_.setZero();
  started_ = holding_ = false;
  grip_samples_ = 0;
}

void ForceAmplifier::watch_grip(double grip_N) noexcept {
  const bool gone = grip_N < kGripLost_N;
  grip_samples_ = gone == holding_ ? 0 : grip_samples_ + 1;
  if (grip_samples_ * settings_.sample_time_s < kGripBounce_s) return;
  grip_samples_ = 0;
  holding_ = gone;
  if (holding_) {
    hold_m_ = position_m_;
    return;
  }
  // Taken up again: as at the start, but from here.
  offset_m_ = reference_m_;
  states_.setZero();
  last_desired_m_.setZero();
  for (auto& filter : environment_filter_) filter.reset();
  for (auto& row : hand_filter_) {
    for (auto& filter : row) filter.reset();
  }
}

void ForceAmplifier::follow_forces(const ControllerInput& input) noexcept {
  const Vector2d hand = -plane(input.sensed_force_N), environment = -plane(input.environment_force_N);
  Vector2d command = extra_m_;
  for (std::size_t i = 0; i < 2; ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    command[row] += hand_filter_[i][0].step(hand[0]) + hand_filter_[i][1].step(hand[1]) +
                    environment_filter_[i].step(environment[row]);
  }
  const auto& g = settings_.primary;
  states_ = (advance_ * states_ + take_ * (command + last_desired_m_).transpose()).eval();
  last_desired_m_ = command;
  const Vector2d third =
      (command - states_.row(2).transpose() - g.d1 * states_.row(1).transpose() - g.d0 * states_.row(0).transpose()) /
      g.d3;
  desired_m_ = offset_m_ + command;
  reference_m_ = offset_m_ + g.n1 * states_.row(1).transpose() + g.n0 * states_.row(0).transpose();
  reference_m_per_s_ = g.n1 * states_.row(2).transpose() + g.n0 * states_.row(1).transpose();
  reference_m_per_s2_ = g.n1 * third + g.n0 * states_.row(2).transpose();
}

void ForceAmplifier::hold() noexcept {
  const double T = settings_.sample_time_s;
  desired_m_ = hold_m_;
  reference_m_per_s2_ =
      kHold_rad_per_s * kHold_rad_per_s * (hold_m_ - reference_m_) - 2.0 * kHold_rad_per_s * reference_m_per_s_;
  reference_m_per_s_ += T * reference_m_per_s2_;
  reference_m_ += T * reference_m_per_s_;
}

ControllerOutput ForceAmplifier::step(const ControllerInput& input) noexcept {
  const Vector2d th = input.joint_rad.head<2>();
  position_m_ = plane(input.mechanism.tip_m) - origin_m_;
  if (!started_) {
    // Stays where it is found, however far from home that is.
    offset_m_ = reference_m_ = position_m_;
    reference_m_per_s_.setZero();
    error_m_.setZero();
    joint_rad_ = th;
    started_ = true;
  }
  watch_grip(input.grip_force_N);
  holding_ ? hold() : follow_forces(input);

  const double T = settings_.sample_time_s, keep = velocity_pole_;
  const Vector2d error = reference_m_ - position_m_;
  error_rate_m_per_s_ = keep * error_rate_m_per_s_ + (1.0 - keep) / T * (error - error_m_);
  error_m_ = error;
  rate_rad_per_s_ = keep * rate_rad_per_s_ + (1.0 - keep) / T * (th - joint_rad_);
  joint_rad_ = th;

  const double w = settings_.bandwidth_rad_per_s;
  const Vector2d acceleration = reference_m_per_s2_ + 2.0 * w * error_rate_m_per_s_ + w * w * error;
  const Eigen::Matrix2d jacobian = models::seven_bar_jacobian(settings_.device, th, settings_.device.handle_m);
  ControllerOutput output;
  Vector2d torque = models::seven_bar_coriolis(inertia_, th, rate_rad_per_s_) + models::seven_bar_gravity(inertia_, th);
  if (std::abs(jacobian.determinant()) > kSingular) {
    const Vector2d bias = models::seven_bar_bias_acceleration(settings_.device, th, rate_rad_per_s_);
    torque += models::seven_bar_mass_matrix(inertia_, th) * (jacobian.inverse() * (acceleration - bias)) +
              jacobian.transpose() * plane(input.sensed_force_N);
  }
  output.feedforward_torque_Nm.head<2>() = torque;
  return output;
}

TransferFunction filter_of(const models::ForceAmplifierSettings& s) {
  return {list(s.filter_numerator_m_per_N), list(s.filter_denominator)};
}

TransferMatrix alpha_of(const models::ForceAmplifierSettings& s) {
  const auto denominator = list(s.alpha_denominator);
  TransferMatrix alpha;
  alpha.entries[0] = {TransferFunction{list(s.alpha_xx), denominator}, TransferFunction{list(s.alpha_xy), denominator}};
  alpha.entries[1] = {TransferFunction{list(s.alpha_yx), denominator}, TransferFunction{list(s.alpha_yy), denominator}};
  return alpha;
}

ForceAmplifier make_force_amplifier(const models::Scenario& scenario) {
  const auto& f = scenario.force_amplifier;
  ForceAmplifier::Settings settings;
  settings.device = seven_bar_of(scenario);
  settings.K = filter_of(f);
  settings.alpha = alpha_of(f);
  settings.home_rad = {scenario.device.pose_rad[0], scenario.device.pose_rad[1]};
  settings.bandwidth_rad_per_s = f.inner_bandwidth_rad_per_s;
  settings.sample_time_s = scenario.loop.sample_time_s;
  try {
    return ForceAmplifier(settings);
  } catch (const InputError& error) {
    throw InputError("scenario '" + scenario.name + "': [force_amplifier] alpha and filter: " + error.what());
  }
}

}  // namespace handloop::control
