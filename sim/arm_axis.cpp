#include "sim/arm_axis.h"

#include <algorithm>
#include <cmath>

namespace handloop::sim {
namespace {

using models::Place;

/// L of the arm's mass (position, velocity) with the stylus held still.
Eigen::Matrix2d held_arm(const models::ArmParameters& arm, double extra_mass_kg) {
  const double mass = arm.mass_kg + extra_mass_kg;
  Eigen::Matrix2d linear;
  linear << 0, 1, -(arm.k1_N_per_m + arm.k2_N_per_m) / mass, -(arm.b1_Ns_per_m + arm.b2_Ns_per_m) / mass;
  return linear;
}

}  // namespace

ArmAxis::ArmAxis(const models::ArmSettings& settings, models::Axis axis, const std::vector<models::EffectPtr>& effects,
                 double step_s)
    : kind_(Kind::none), step_s_(step_s) {
  const auto index = static_cast<std::size_t>(axis);
  model_.arm = settings.axes[index];
  if (settings.attached) kind_ = settings.rigid[index] ? Kind::rigid : Kind::arm;
  if (kind_ == Kind::rigid) {
    model_.base = models::BaseModel::msd;
    model_.msd = *settings.rigid[index];
  }
  std::size_t states = 0;
  double extra_mass = 0;
  for (const auto& effect : effects) {
    if (effect->acts_on_signal() || (kind_ == Kind::none && effect->place() != Place::joint)) continue;
    const double delay = effect->delay_s();
    effects_.push_back(
        {effect, model_.port_base(effect->place()), delay > 0 ? DelayLine(delay, step_s) : DelayLine(), states});
    states += effect->state_count();
    if (effect->place() == Place::arm) extra_mass += effect->added_mass_kg(0.0);
  }
  effect_start_.resize(states);
  effect_state_.resize(states);
  for (auto& rates : effect_rates_) rates.resize(states);
  if (kind_ == Kind::arm) exponential_ = ExponentialStep(held_arm(model_.arm, extra_mass), step_s);
}

void ArmAxis::reset() {
  start_.setZero();
  state_.setZero();
  std::ranges::fill(effect_start_, 0.0);
  std::ranges::fill(effect_state_, 0.0);
  for (auto& acting : effects_) acting.past.reset();
}

std::span<const double> ArmAxis::states_of(const Acting& acting) const {
  return std::span(effect_state_).subspan(acting.first_state, acting.effect->state_count());
}

models::PortMotion ArmAxis::port(const Acting& acting, const AxisMotion& motion) const {
  models::PortMotion at;
  at.t_s = motion.t_s;
  switch (kind_ == Kind::rigid ? Place::joint : acting.effect->place()) {
    case Place::arm:
      at.x_m = state_[0] - motion.rest_m;
      at.v_m_per_s = state_[1] - motion.rest_m_per_s;
      break;
    case Place::grasp:
      at.x_m = motion.grip_m - state_[0];
      at.v_m_per_s = motion.grip_m_per_s - state_[1];
      break;
    default:  // a rigid hand is all one with the grip
      at.x_m = motion.grip_m - (acting.effect->place() == Place::joint ? 0.0 : motion.rest_m);
      at.v_m_per_s = motion.grip_m_per_s - (acting.effect->place() == Place::joint ? 0.0 : motion.rest_m_per_s);
  }
  const auto past = acting.past.at_delay(motion.t_s, {at.x_m, at.v_m_per_s});
  at.delayed_x_m = past.x_m;
  at.delayed_v_m_per_s = past.v_m_per_s;
  return at;
}

void ArmAxis::remember(const AxisMotion& start) {
  for (auto& acting : effects_) {
    if (acting.past.delay_s() <= 0) continue;
    const auto at = port(acting, start);
    acting.past.push(start.t_s, {at.x_m, at.v_m_per_s});
  }
}

/// Sums up what acts on stylus and arm's mass at the present state; mass_m_per_s2 is the acceleration of the mass.
AxisReaction ArmAxis::balance(const AxisMotion& motion, double& mass_m_per_s2) const {
  AxisReaction sum;
  double mass = 0.0, arm_N = 0.0, joint_N = 0.0;
  if (kind_ == Kind::arm) {
    const auto& arm = model_.arm;
    mass = arm.mass_kg;
    sum.grasp_N = arm.k1_N_per_m * (motion.grip_m - state_[0]) + arm.b1_Ns_per_m * (motion.grip_m_per_s - state_[1]);
    arm_N = arm.k2_N_per_m * (state_[0] - motion.rest_m) + arm.b2_Ns_per_m * (state_[1] - motion.rest_m_per_s) -
            motion.muscle_N;
  } else if (kind_ == Kind::rigid) {
    const auto& msd = model_.msd;
    mass = msd.mass_kg;
    arm_N = msd.k_N_per_m * (motion.grip_m - motion.rest_m) +
            msd.b_Ns_per_m * (motion.grip_m_per_s - motion.rest_m_per_s) - motion.muscle_N;
  }
  for (const auto& acting : effects_) {
    const double force = acting.effect->force_N(port(acting, motion), acting.base, states_of(acting));
    const double added = acting.effect->added_mass_kg(motion.t_s);
    switch (acting.effect->place()) {
      case Place::arm:
        arm_N += force;
        mass += added;
        break;
      case Place::grasp:
        sum.grasp_N += force;
        sum.inertia_kg += added;
        break;
      default:
        joint_N += force;
        sum.inertia_kg += added;
    }
  }
  if (kind_ == Kind::rigid) {
    sum.grasp_N += arm_N;
    sum.inertia_kg += mass;
  }
  sum.force_N = sum.grasp_N + joint_N;
  mass_m_per_s2 = kind_ == Kind::arm ? (sum.grasp_N - arm_N) / mass : 0.0;
  return sum;
}

AxisReaction ArmAxis::reaction(const AxisMotion& motion) const {
  double unused = 0.0;
  return balance(motion, unused);
}

AxisReaction ArmAxis::evaluate(int stage, const AxisMotion& motion) {
  if (stage == 0) {
    start_ = state_;
    std::ranges::copy(effect_state_, effect_start_.begin());
  }
  double acceleration = 0.0;
  const auto sum = balance(motion, acceleration);
  if (kind_ == Kind::arm) nonlinear_[stage] = Eigen::Vector2d(state_[1], acceleration) - exponential_.linear() * state_;
  for (const auto& acting : effects_) {
    const auto count = acting.effect->state_count();
    if (count == 0) continue;
    acting.effect->state_rates(port(acting, motion), acting.base, states_of(acting),
                               std::span(effect_rates_[stage]).subspan(acting.first_state, count));
  }
  return sum;
}

void ArmAxis::advance_to(int stage) {
  if (kind_ == Kind::arm) state_ = exponential_.stage(stage, start_, nonlinear_);
  const double h = step_s_;
  const auto& rates = effect_rates_;
  for (std::size_t i = 0; i < effect_state_.size(); ++i) {
    double change = 0;
    switch (stage) {
      case 1:
        change = 0.5 * h * rates[0][i];
        break;
      case 2:
        change = 0.5 * h * rates[1][i];
        break;
      case 3:
        change = h * rates[2][i];
        break;
      default:
        change = h / 6 * (rates[0][i] + 2 * rates[1][i] + 2 * rates[2][i] + rates[3][i]);
    }
    effect_state_[i] = effect_start_[i] + change;
  }
}

double ArmAxis::energy_J(const AxisMotion& motion) const {
  if (kind_ == Kind::none) return 0.0;
  if (kind_ == Kind::rigid) {
    const double stretch = motion.grip_m - motion.rest_m;
    return 0.5 *
           (model_.msd.mass_kg * motion.grip_m_per_s * motion.grip_m_per_s + model_.msd.k_N_per_m * stretch * stretch);
  }
  const auto& arm = model_.arm;
  const double grasp = motion.grip_m - state_[0], stretch = state_[0] - motion.rest_m;
  return 0.5 *
         (arm.mass_kg * state_[1] * state_[1] + arm.k1_N_per_m * grasp * grasp + arm.k2_N_per_m * stretch * stretch);
}

}  // namespace handloop::sim
