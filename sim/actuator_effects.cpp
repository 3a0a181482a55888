#include "sim/actuator_effects.h"

#include <Eigen/Dense>
#include <algorithm>

namespace handloop::sim {

std::vector<models::EffectPtr> effects_of(const models::Scenario& scenario, models::Axis axis) {
  std::vector<models::EffectPtr> effects;
  for (const auto& [where, effect] : scenario.arm.effects) {
    if (where == axis) effects.push_back(effect);
  }
  return effects;
}

ActuatorEffects::ActuatorEffects(const models::Scenario& scenario, double step_s) : half_step_s_(0.5 * step_s) {
  for (const auto axis : models::kAxes) {
    const auto i = static_cast<std::size_t>(axis);
    paths_[i] = SignalPath(effects_of(scenario, axis), models::Place::actuator, half_step_s_);
    past_[i].resize(static_cast<std::size_t>(paths_[i].delay_s() / half_step_s_) + 2);
    any_ = any_ || !paths_[i].empty();
  }
}

void ActuatorEffects::reset() {
  for (auto& path : paths_) path.reset();
  for (auto& past : past_) std::ranges::fill(past, 0.0);
  half_steps_ = 0;
  start_.setZero();
  middle_.setZero();
  end_.setZero();
}

double ActuatorEffects::delayed(std::size_t axis, std::uint64_t half_step, double now) {
  auto& past = past_[axis];
  past[half_step % past.size()] = now;
  const double late = paths_[axis].delay_s() / half_step_s_;
  const auto whole = static_cast<std::uint64_t>(late);
  const double part = late - static_cast<double>(whole);
  const auto before = [&](std::uint64_t steps) {
    return steps > half_step ? 0.0 : past[(half_step - steps) % past.size()];
  };
  return (1 - part) * before(whole) + part * before(whole + 1);
}

void ActuatorEffects::begin_step(double t_s, const TipState& tip, const Eigen::Vector3d& torque_Nm) {
  if (!any_) return;
  const Eigen::Vector3d commanded = tip.jacobian.transpose().partialPivLu().solve(torque_Nm);
  for (const auto axis : models::kAxes) {
    const auto i = static_cast<std::size_t>(axis);
    auto& path = paths_[i];
    if (path.empty()) continue;
    const int row = models::device_row(axis);
    const double first = delayed(i, half_steps_, commanded[row]), second = delayed(i, half_steps_ + 1, commanded[row]);
    const double add = path.addition(t_s) - commanded[row];
    start_[row] = path.output(first) + add;
    path.step(first, first);
    middle_[row] = 0.5 * (path.output(first) + path.output(second)) + add;
    path.step(second, second);
    end_[row] = path.output(second) + add;
  }
  half_steps_ += 2;
}

}  // namespace handloop::sim
