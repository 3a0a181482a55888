#include "models/effects/describing_function.h"
#include "models/effects/entry.h"

namespace handloop::models {
namespace {

const EffectInfo kInfo{
    .name = "stribeck_friction",
    .title = "Stribeck friction",
    .equation = "F = (force_N + excess_N exp(-(v / stribeck_m_per_s)^2)) tanh(v / smoothing_m_per_s)",
    .source = "R. Stribeck 1902; Armstrong-Helouvry, Dupont and Canudas de Wit, Automatica 30 (1994) 1083, eq. (8)",
    .fingerprint = "force that follows the sign of the velocity and falls as it grows",
    .experiment = "repeat at a fifth of the force: breakaway shows where motion is slow",
    .places = {Place::arm, Place::joint, Place::grasp},
    .parameters = {{"force_N", "N", 0.0, 1e4, 0.1, "friction at speed"},
                   {"excess_N", "N", 0.0, 1e4, 0.1, "what breakaway takes beyond it"},
                   {"stribeck_m_per_s",
                    "m/s",
                    1e-4,
                    10.0,
                    0.02,
                    "speed at which the excess has fallen to 37 %",
                    {Role::shape, 0.15, 1.2, 3, Scale::velocity}},
                   {"smoothing_m_per_s",
                    "m/s",
                    1e-5,
                    1.0,
                    0.003,
                    "speed at which 76 % of it is reached",
                    {Role::shape, 0.03, 0.15, 2, Scale::velocity}}},
    .search_places = {Place::arm},
};

class StribeckFriction final : public Effect {
 public:
  StribeckFriction(Place place, std::span<const double> values) : Effect(kInfo, place, values) {}
  double force_N(const PortMotion& motion, const PortBase&, std::span<const double>) const override {
    return law(motion.v_m_per_s);
  }
  LinearElement linearise(const OperatingPoint& point, const PortBase&) const override {
    return {.damping_Ns_per_m = random_input_gain([this](double v) { return law(v); }, point.v_rms_m_per_s)};
  }

 private:
  double law(double v) const {
    const double ratio = v / value(2);
    return (value(0) + value(1) * std::exp(-ratio * ratio)) * std::tanh(v / value(3));
  }
};

}  // namespace

EffectType stribeck_friction_effect() {
  return effect_entry<StribeckFriction>(kInfo);
}

}  // namespace handloop::models
