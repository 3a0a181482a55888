#include "identify/explain/place_effects.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace handloop::identify {

using models::Effect;
using models::PortMotion;

PlaceEffects::PlaceEffects(const models::AxisModel& model, models::Place place, double h_s, std::size_t steps,
                           double start_time_s)
    : base_(model.port_base(place)), h_s_(h_s), start_time_s_(start_time_s), steps_(steps) {
  for (const auto& effect : model.effects) {
    if (effect->place() == place && effect->info().name != "tremor") add(*effect);
  }
}

PlaceEffects::PlaceEffects(const Effect& effect, const models::PortBase& base, double h_s, std::size_t steps,
                           double start_time_s)
    : base_(base), h_s_(h_s), start_time_s_(start_time_s), steps_(steps) {
  add(effect);
}

void PlaceEffects::add(const Effect& effect) {
  acting_.push_back(
      {&effect, effect.delay_s() / h_s_, effect.added_mass_kg(0.0), std::vector<double>(effect.state_count(), 0.0)});
  if (effect.delay_s() > 0 && !looks_back_) {
    looks_back_ = true;
    past_x_m_.assign(steps_ + 1, 0.0);
    past_v_m_per_s_.assign(steps_ + 1, 0.0);
  }
}

double PlaceEffects::constant_mass_kg() const {
  double mass = 0;
  for (const auto& acting : acting_) mass += acting.constant_mass_kg;
  return mass;
}

models::LinearElement PlaceEffects::steepest() const {
  models::LinearElement sum;
  for (const auto& acting : acting_) {
    const auto element = acting.effect->linearise({.x_rms_m = 1e-8, .v_rms_m_per_s = 1e-7}, base_);
    sum.stiffness_N_per_m += std::abs(element.stiffness_N_per_m);
    sum.damping_Ns_per_m += std::abs(element.damping_Ns_per_m);
  }
  return sum;
}

PortMotion PlaceEffects::port(const Acting& acting, double step, double x_m, double v_m_per_s) const {
  PortMotion motion{start_time_s_ + step * h_s_, x_m, v_m_per_s};
  if (acting.delay_steps > 0) {
    const double at = step - acting.delay_steps;
    if (at > 0) {
      const auto before = std::min(static_cast<std::size_t>(at), steps_ - 1);
      const double share = at - static_cast<double>(before);
      motion.delayed_x_m = past_x_m_[before] + share * (past_x_m_[before + 1] - past_x_m_[before]);
      motion.delayed_v_m_per_s =
          past_v_m_per_s_[before] + share * (past_v_m_per_s_[before + 1] - past_v_m_per_s_[before]);
    }
  }
  return motion;
}

double PlaceEffects::force_N(std::size_t step, double x_m, double v_m_per_s, double a_m_per_s2) const {
  double force = 0;
  for (const auto& acting : acting_) {
    const auto motion = port(acting, static_cast<double>(step), x_m, v_m_per_s);
    force += acting.effect->force_N(motion, base_, acting.states) +
             (acting.effect->added_mass_kg(motion.t_s) - acting.constant_mass_kg) * a_m_per_s2;
  }
  return force;
}

void PlaceEffects::advance(std::size_t step, double x0, double v0, double x1, double v1) {
  // Runge and Kutta's classical rule, the motion between the two ends taken as straight
  const double from = static_cast<double>(step);
  for (auto& acting : acting_) {
    const auto n = acting.states.size();
    if (n == 0) continue;
    const auto start = port(acting, from, x0, v0), middle = port(acting, from + 0.5, 0.5 * (x0 + x1), 0.5 * (v0 + v1)),
               end = port(acting, from + 1.0, x1, v1);
    constexpr std::size_t kMostStates = 8;
    using Stage = std::array<double, kMostStates>;
    Stage at, first, second, third, fourth;
    const auto rates = [&](const PortMotion& motion, const Stage& slope, double reach_s, Stage& found) {
      for (std::size_t i = 0; i < n; ++i) at[i] = acting.states[i] + reach_s * slope[i];
      acting.effect->state_rates(motion, base_, {at.data(), n}, {found.data(), n});
    };
    acting.effect->state_rates(start, base_, acting.states, {first.data(), n});
    rates(middle, first, 0.5 * h_s_, second);
    rates(middle, second, 0.5 * h_s_, third);
    rates(end, third, h_s_, fourth);
    for (std::size_t i = 0; i < n; ++i)
      acting.states[i] += h_s_ / 6 * (first[i] + 2 * (second[i] + third[i]) + fourth[i]);
  }
}

void PlaceEffects::remember(std::size_t step, double x_m, double v_m_per_s) {
  if (!looks_back_ || step >= past_x_m_.size()) return;
  past_x_m_[step] = x_m;
  past_v_m_per_s_[step] = v_m_per_s;
  if (step + 1 < past_x_m_.size()) {  // looked at where a delay is shorter than a step
    past_x_m_[step + 1] = x_m;
    past_v_m_per_s_[step + 1] = v_m_per_s;
  }
}

}  // namespace handloop::identify
