#include <algorithm>
#include <cmath>
#include <numbers>

#include "models/effects/entry.h"

namespace handloop::models {
namespace {

const EffectInfo kInfo{
    .name = "reflex_feedback",
    .title = "Reflex feedback",
    .equation =
        "F = low-pass(u), u = position_gain_N_per_m x(t - delay_s) + velocity_gain_Ns_per_m v(t - delay_s); "
        "`order` poles at cutoff_Hz; with direction +1 or -1 only stretch of that sign is felt",
    .source =
        "Kazerooni and Her, appendix, G_f = C / (s + lambda) with delay; rectified velocity as in Kearney, Stein and "
        "Parameswaran, IEEE TBME 44 (1997) 493; neural delay of Fu and Cavusoglu II-D",
    .fingerprint = "force that answers stretch tens of milliseconds later",
    .experiment = "a pulse of 20 ms: the answer stands apart from the stimulus",
    .places = {Place::arm},
    .parameters =
        {{"velocity_gain_Ns_per_m", "Ns/m", -1e5, 1e5, 2.0, "resisting force for a stretch velocity"},
         {"position_gain_N_per_m", "N/m", -1e6, 1e6, 0.0, "resisting force for a stretch"},
         {"delay_s", "s", 0.01, 0.2, 0.04, "from stretch to force", {Role::shape, 0.012, 0.1, 7, Scale::absolute}},
         {"cutoff_Hz", "Hz", 0.2, 100.0, 5.0, "of muscle activation", {Role::shape, 0.7, 20, 4, Scale::absolute, true}},
         {"order", "", 1.0, 2.0, 1.0, "of the low-pass, 1 or 2", {Role::choice, 1, 2, 2, Scale::absolute}},
         {"direction",
          "",
          -1.0,
          1.0,
          0.0,
          "0: both; +1 or -1: half-wave rectified",
          {Role::choice, -1, 1, 3, Scale::absolute}}},
    .search_places = {Place::arm},
};

class ReflexFeedback final : public Effect {
 public:
  ReflexFeedback(Place place, std::span<const double> values) : Effect(kInfo, place, values) {}
  std::size_t state_count() const override { return second_order() ? 2 : 1; }
  double delay_s() const override { return value(2); }
  double force_N(const PortMotion&, const PortBase&, std::span<const double> states) const override {
    return states[second_order() ? 1 : 0];
  }
  void state_rates(const PortMotion& motion, const PortBase&, std::span<const double> states,
                   std::span<double> rates) const override {
    double x = motion.delayed_x_m, v = motion.delayed_v_m_per_s;
    if (value(5) > 0.5) {
      x = std::max(x, 0.0);
      v = std::max(v, 0.0);
    } else if (value(5) < -0.5) {
      x = std::min(x, 0.0);
      v = std::min(v, 0.0);
    }
    const double rate = 2 * std::numbers::pi * value(3);
    rates[0] = rate * (value(0) * v + value(1) * x - states[0]);
    if (second_order()) rates[1] = rate * (states[0] - states[1]);
  }
  LinearElement linearise(const OperatingPoint&, const PortBase&) const override {
    const double share = std::abs(value(5)) > 0.5 ? 0.5 : 1.0;  // E[max(u, 0) u] = 1/2 E[u^2]
    const double tau = 1 / (2 * std::numbers::pi * value(3));
    LinearElement element{.numerator = {share * value(0), share * value(1)}, .delay_s = value(2)};
    element.denominator = second_order() ? std::vector{tau * tau, 2 * tau, 1.0} : std::vector{tau, 1.0};
    return element;
  }

 private:
  bool second_order() const { return value(4) > 1.5; }
};

}  // namespace

EffectType reflex_feedback_effect() {
  return effect_entry<ReflexFeedback>(kInfo);
}

}  // namespace handloop::models
