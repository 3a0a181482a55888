#include "models/effects/describing_function.h"
#include "models/effects/entry.h"

namespace handloop::models {
namespace {

const EffectInfo kInfo{
    .name = "coulomb_friction",
    .title = "Coulomb friction",
    .equation = "F = force_N tanh(v / smoothing_m_per_s)",
    .source = "C.-A. Coulomb 1785; smoothed as in Andersson et al., Tribology Int. 40 (2007) 580",
    .fingerprint = "force that follows the sign of the velocity, whatever its size",
    .experiment = "repeat at a third of the force: the share of dry friction grows",
    .places = {Place::arm, Place::joint, Place::grasp},
    .parameters = {{"force_N", "N", 0.0, 1e4, 0.15, "friction once it slides"},
                   {"smoothing_m_per_s",
                    "m/s",
                    1e-5,
                    1.0,
                    0.005,
                    "speed at which 76 % of it is reached",
                    {Role::shape, 0.03, 0.5, 3, Scale::velocity}}},
    .search_places = {Place::arm},
};

class CoulombFriction final : public Effect {
 public:
  CoulombFriction(Place place, std::span<const double> values) : Effect(kInfo, place, values) {}
  double force_N(const PortMotion& motion, const PortBase&, std::span<const double>) const override {
    return value(0) * std::tanh(motion.v_m_per_s / value(1));
  }
  LinearElement linearise(const OperatingPoint& point, const PortBase&) const override {
    const auto law = [this](double v) { return value(0) * std::tanh(v / value(1)); };
    return {.damping_Ns_per_m = random_input_gain(law, point.v_rms_m_per_s)};
  }
};

}  // namespace

EffectType coulomb_friction_effect() {
  return effect_entry<CoulombFriction>(kInfo);
}

}  // namespace handloop::models
