#include <cmath>

#include "models/effects/entry.h"

namespace handloop::models {
namespace {

enum : std::size_t { kStiffness, kDamping, kMass, kLevelling, kCentre, kWidth };

const EffectInfo kInfo{
    .name = "parameter_drift",
    .title = "Parameter drift",
    .equation =
        "F = g(t) (stiffness_rate_N_per_m_s x + damping_rate_Ns_per_m_s v + mass_rate_kg_per_s a); g = t, or, where it "
        "levels off, 4 width_s (L((t - centre_s)/width_s) - L(-centre_s/width_s)) with L(u) = 1/(1 + exp(-u))",
    .source =
        "fatigue and change of grasp over a trial (Fu and Cavusoglu II-C); time from the record's start. The logistic "
        "curve covers a change at one time (small width) and one that settles (centre near the start)",
    .fingerprint = "error that grows with time in the record",
    .experiment = "a second record right after the first, and one after a rest",
    .places = {Place::arm, Place::grasp},
    .parameters =
        {{"stiffness_rate_N_per_m_s", "N/m/s", -1e5, 1e5, 0.5,
          "change of the stiffness beside it each second; where it levels off, at its fastest"},
         {"damping_rate_Ns_per_m_s", "Ns/m/s", -1e4, 1e4, 0.0, "change of the damping each second"},
         {"mass_rate_kg_per_s", "kg/s", -10.0, 10.0, 0.0, "change of the mass each second (arm only)"},
         {"levelling", "", 0.0, 1.0, 0.0, "0: as long as the record lasts; 1: levels off", {Role::choice, 0, 1, 2}},
         {"centre_s",
          "s",
          0.0,
          1e5,
          30.0,
          "time of the fastest change, where it levels off",
          {Role::shape, 1, 40, 5, Scale::absolute, true}},
         {"width_s",
          "s",
          0.01,
          1e5,
          5.0,
          "a tenth to nine tenths take 4.4 of these, where it levels off",
          {Role::shape, 1.5, 16, 3, Scale::absolute, true}}},
    .search_places = {Place::arm, Place::grasp},
};

class ParameterDrift final : public Effect {
 public:
  ParameterDrift(Place place, std::span<const double> values) : Effect(kInfo, place, values) {}
  double force_N(const PortMotion& motion, const PortBase&, std::span<const double>) const override {
    return elapsed(motion.t_s) * (value(kStiffness) * motion.x_m + value(kDamping) * motion.v_m_per_s);
  }
  double added_mass_kg(double t_s) const override { return place() == Place::arm ? value(kMass) * elapsed(t_s) : 0.0; }
  bool uses(std::size_t parameter) const override {
    if (parameter == kMass) return place() == Place::arm;
    return (parameter != kCentre && parameter != kWidth) || levels_off();
  }
  LinearElement linearise(const OperatingPoint& point, const PortBase&) const override {
    return {.stiffness_N_per_m = value(kStiffness) * elapsed(point.t_s),
            .damping_Ns_per_m = value(kDamping) * elapsed(point.t_s),
            .mass_kg = added_mass_kg(point.t_s)};
  }

 private:
  bool levels_off() const { return value(kLevelling) > 0.5; }
  /// Time that counts, s: all of it, or what a logistic curve of slope 1 at its centre leaves.
  double elapsed(double t_s) const {
    if (!levels_off()) return t_s;
    const double width = value(kWidth), centre = value(kCentre);
    const auto logistic = [](double u) { return 1 / (1 + std::exp(-u)); };
    return 4 * width * (logistic((t_s - centre) / width) - logistic(-centre / width));
  }
};

}  // namespace

EffectType parameter_drift_effect() {
  return effect_entry<ParameterDrift>(kInfo);
}

}  // namespace handloop::models
