#include "models/effects/entry.h"

namespace handloop::models {
namespace {

const EffectInfo kInfo{
    .name = "viscoelastic_relaxation",
    .title = "Viscoelastic relaxation (Maxwell element)",
    .equation = "F = stiffness_N_per_m z, z' = v - z / time_constant_s",
    .source = "J. C. Maxwell 1867; standard linear solid of muscle and tendon (Fung, Biomechanics, 1993, ch. 2)",
    .fingerprint = "force that fades after a displacement",
    .experiment = "a step held for ten time constants",
    .places = {Place::arm, Place::grasp, Place::joint},
    .parameters = {{"stiffness_N_per_m", "N/m", 0.0, 1e7, 50.0, "of the relaxing spring"},
                   {"time_constant_s",
                    "s",
                    0.003,
                    20.0,
                    0.2,
                    "in which its force falls to 37 %",
                    {Role::shape, 0.01, 2, 6, Scale::absolute}}},
    .search_places = {Place::arm, Place::grasp},
};

class ViscoelasticRelaxation final : public Effect {
 public:
  ViscoelasticRelaxation(Place place, std::span<const double> values) : Effect(kInfo, place, values) {}
  std::size_t state_count() const override { return 1; }
  double force_N(const PortMotion&, const PortBase&, std::span<const double> states) const override {
    return value(0) * states[0];
  }
  void state_rates(const PortMotion& motion, const PortBase&, std::span<const double> states,
                   std::span<double> rates) const override {
    rates[0] = motion.v_m_per_s - states[0] / value(1);
  }
  LinearElement linearise(const OperatingPoint&, const PortBase&) const override {
    return {.numerator = {value(0) * value(1), 0.0}, .denominator = {value(1), 1.0}};
  }
};

}  // namespace

EffectType viscoelastic_relaxation_effect() {
  return effect_entry<ViscoelasticRelaxation>(kInfo);
}

}  // namespace handloop::models
