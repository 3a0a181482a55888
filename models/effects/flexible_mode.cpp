#include <cmath>
#include <numbers>

#include "models/effects/entry.h"

namespace handloop::models {
namespace {

const EffectInfo kInfo{
    .name = "flexible_mode",
    .title = "Flexible mode",
    .equation =
        "a mass mass_kg on a spring of frequency_Hz and damping_ratio rides on the place: "
        "F = -(k (y - x) + b (y' - v)), mass_kg y'' = -k (y - x) - b (y' - v)",
    .source =
        "vibration absorber, Den Hartog, Mechanical Vibrations, ch. 3; modes of the Phantom: Diaz and Gil, TRO 26 "
        "(2010) 160",
    .fingerprint = "resonance and antiresonance coherent with the input",
    .experiment = "excitation concentrated about the found frequency",
    .places = {Place::arm, Place::joint},
    .parameters =
        {{"mass_kg", "kg", 0.0, 1e3, 0.05, "that rides on the spring"},
         {"frequency_Hz",
          "Hz",
          0.3,
          400.0,
          15.0,
          "with the place held fast",
          {Role::shape, 2, 40, 12, Scale::absolute}},
         {"damping_ratio", "", 0.001, 2.0, 0.05, "of that mode", {Role::shape, 0.03, 0.3, 2, Scale::absolute, true}}},
    .search_places = {Place::arm},
};

class FlexibleMode final : public Effect {
 public:
  FlexibleMode(Place place, std::span<const double> values) : Effect(kInfo, place, values) {}
  std::size_t state_count() const override { return 2; }  // extension y - x, velocity y'
  double force_N(const PortMotion& motion, const PortBase&, std::span<const double> states) const override {
    return -value(0) * specific_force(motion, states);
  }
  void state_rates(const PortMotion& motion, const PortBase&, std::span<const double> states,
                   std::span<double> rates) const override {
    rates[0] = states[1] - motion.v_m_per_s;
    rates[1] = -specific_force(motion, states);
  }
  LinearElement linearise(const OperatingPoint&, const PortBase&) const override {
    // m s^2 (b s + k) / (m s^2 + b s + k)
    const double m = value(0), w = omega(), zeta = value(2);
    return {.numerator = {m * 2 * zeta * w, m * w * w, 0.0, 0.0}, .denominator = {1.0, 2 * zeta * w, w * w}};
  }

 private:
  double omega() const { return 2 * std::numbers::pi * value(1); }
  /// Spring and damper pull of the place on the riding mass, for each kg of it.
  double specific_force(const PortMotion& motion, std::span<const double> states) const {
    const double w = omega();
    return w * w * states[0] + 2 * value(2) * w * (states[1] - motion.v_m_per_s);
  }
};

}  // namespace

EffectType flexible_mode_effect() {
  return effect_entry<FlexibleMode>(kInfo);
}

}  // namespace handloop::models
