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
  constexpr std::size_t kMostStates = 8;
  std::array<double, kMostStates> stage{}, rates{}, sum{};
  const double from = static_cast<double>(step);
  for (auto& acting : acting_) {
    const auto n = acting.states.size();
    if (n == 0) continue;
    const std::array motions{port(acting, from, x0, v0), port(acting, from + 0.5, 0.5 * (x0 + x1), 0.5 * (v0 + v1)),
                             port(acting, from + 1.0, x1, v1)};
    const std::array<std::size_t, 4> at{0, 1, 1, 2};
    const std::array<double, 4> reach{0.0, 0.5, 0.5, 1.0}, weight{1, 2, 2, 1};
    sum.fill(0.0);
    for (std::size_t k = 0; k < 4; ++k) {
      for (std::size_t i = 0; i < n; ++i) stage[i] = acting.states[i] + (k == 0 ? 0.0 : reach[k] * h_s_ * rates[i]);
      acting.effect->state_rates(motions[at[k]], base_, {stage.data(), n}, {rates.data(), n});
      for (std::size_t i = 0; i < n; ++i) sum[i] += weight[k] * rates[i];
    }
    for (std::size_t i = 0; i < n; ++i) acting.states[i] += h_s_ / 6 * sum[i];
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
