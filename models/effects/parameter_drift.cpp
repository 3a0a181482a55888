#include "models/effects/entry.h"

namespace handloop::models {
namespace {

const EffectInfo kInfo{
    .name = "parameter_drift",
    .title = "Parameter drift",
    .equation = "F = t (stiffness_rate_N_per_m_s x + damping_rate_Ns_per_m_s v + mass_rate_kg_per_s a)",
    .source =
        "fatigue and change of grasp over a trial (Fu and Cavusoglu II-C); linear in time from the record's start",
    .fingerprint = "error that grows with time in the record",
    .experiment = "a second record right after the first, and one after a rest",
    .places = {Place::arm, Place::grasp},
    .parameters = {{"stiffness_rate_N_per_m_s", "N/m/s", -1e5, 1e5, 0.5,
                    "change of the stiffness beside it each second"},
                   {"damping_rate_Ns_per_m_s", "Ns/m/s", -1e4, 1e4, 0.0, "change of the damping each second"},
                   {"mass_rate_kg_per_s", "kg/s", -10.0, 10.0, 0.0, "change of the mass each second (arm only)"}},
    .search_places = {Place::arm, Place::grasp},
};

class ParameterDrift final : public Effect {
 public:
  ParameterDrift(Place place, std::span<const double> values) : Effect(kInfo, place, values) {}
  double force_N(const PortMotion& motion, const PortBase&, std::span<const double>) const override {
    return motion.t_s * (value(0) * motion.x_m + value(1) * motion.v_m_per_s);
  }
  double added_mass_kg(double t_s) const override { return place() == Place::arm ? value(2) * t_s : 0.0; }
  LinearElement linearise(const OperatingPoint& point, const PortBase&) const override {
    return {.stiffness_N_per_m = value(0) * point.t_s,
            .damping_Ns_per_m = value(1) * point.t_s,
            .mass_kg = added_mass_kg(point.t_s)};
  }
};

}  // namespace

EffectType parameter_drift_effect() {
  return effect_entry<ParameterDrift>(kInfo);
}

}  // namespace handloop::models
