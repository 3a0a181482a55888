#include "control/controllers/virtual_wall.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "models/errors.h"

namespace handloop::control {
namespace {

bool possible(const VirtualWallGains& gains) {
  return std::isfinite(gains.stiffness_N_per_m) && gains.stiffness_N_per_m >= 0.0 &&
         std::isfinite(gains.damping_Ns_per_m) && gains.damping_Ns_per_m >= 0.0 && std::isfinite(gains.cutoff_Hz) &&
         gains.cutoff_Hz > 0.0;
}

double filter_pole(const VirtualWall::Settings& settings) {
  return std::exp(-2.0 * std::numbers::pi * settings.gains.cutoff_Hz * settings.sample_time_s);
}

}  // namespace

VirtualWall::VirtualWall(const Settings& settings) : settings_(settings) {
  if (!possible(settings.gains)) {
    throw InputError("virtual wall: stiffness and damping must be finite and not negative, the cut-off positive");
  }
  if (!(settings.sample_time_s > 0.0) || !std::isfinite(settings.sample_time_s)) {
    throw InputError("virtual wall: the sample time must be positive");
  }
  if (settings.row < 0 || settings.row > 2 || !std::isfinite(settings.plane_m)) {
    throw InputError("virtual wall: the plane must be finite and its axis one of the three");
  }
  pole_ = filter_pole(settings_);
}

void VirtualWall::reset() noexcept {
  started_ = false;
  last_p_m_ = 0.0;
  velocity_m_per_s_ = 0.0;
}

bool VirtualWall::set_gains(const VirtualWallGains& gains) noexcept {
  if (!possible(gains)) return false;
  settings_.gains = gains;
  pole_ = filter_pole(settings_);
  return true;
}

ControllerOutput VirtualWall::step(const ControllerInput& input) noexcept {
  ControllerOutput output;
  if (settings_.gravity_compensation) output.feedforward_torque_Nm = input.mechanism.gravity_torque_Nm;

  const double p = input.mechanism.tip_m[settings_.row] - settings_.plane_m;
  if (!started_) last_p_m_ = p;
  started_ = true;
  velocity_m_per_s_ = pole_ * velocity_m_per_s_ + (1.0 - pole_) / settings_.sample_time_s * (p - last_p_m_);
  last_p_m_ = p;

  const double force = -(settings_.gains.stiffness_N_per_m * p + settings_.gains.damping_Ns_per_m * velocity_m_per_s_);
  if (settings_.bilateral) {
    output.in_contact = true;
    output.force_N[settings_.row] = force;
  } else {
    // NaN compares false: it must reach the loop's finite check rather than vanish here.
    output.in_contact = !(p <= 0.0);
    if (output.in_contact) output.force_N[settings_.row] = force > 0.0 ? 0.0 : force;
  }
  return output;
}

VirtualWall make_virtual_wall(const models::Scenario& scenario, const Eigen::Vector3d& tip_at_pose_m) {
  VirtualWall::Settings settings;
  settings.row = models::device_row(scenario.wall.axis);
  settings.plane_m = tip_at_pose_m[settings.row] + scenario.wall.position_m;
  settings.bilateral = scenario.wall.bilateral;
  settings.gravity_compensation = scenario.wall.gravity_compensation;
  settings.sample_time_s = scenario.loop.sample_time_s;
  settings.gains = {scenario.loop.stiffness_N_per_m, scenario.loop.damping_Ns_per_m, scenario.loop.cutoff_Hz};
  return VirtualWall(settings);
}

}  // namespace handloop::control
