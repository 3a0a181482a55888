#include <cmath>

#include "models/effects/entry.h"

namespace handloop::models {
namespace {

enum : std::size_t { kStiffness, kDamping, kMass, kLevelling, kCentre, kWidth };

const EffectInfo kInfo{
    .name = "parameter_drift",
    .title = "Parameter drift",
    .equation =
        "F = g(t) (stiffness_rate_N_per_m_s x + damping_rate_Ns_per_m_s v + mass_rate_kg_per_s a); levelling 0: g = t; "
        "1: g = 4 width_s (L((t - centre_s)/width_s) - L(-centre_s/width_s)), L(u) = 1/(1 + exp(-u)); "
        "2: g = width_s (1 - exp(-t/width_s))",
    .source =
        "fatigue and change of grasp over a trial (Fu and Cavusoglu II-C); time from the record's start. 1 is a change "
        "about one time, 2 one that settles",
    .fingerprint = "error that grows with time in the record",
    .experiment = "a second record right after the first, and one after a rest",
    .places = {Place::arm, Place::grasp},
    .parameters = {{"stiffness_rate_N_per_m_s", "N/m/s", -1e5, 1e5, 0.5,
                    "change of the stiffness beside it each second; at its fastest"},
                   {"damping_rate_Ns_per_m_s", "Ns/m/s", -1e4, 1e4, 0.0, "change of the damping each second"},
                   {"mass_rate_kg_per_s", "kg/s", -10.0, 10.0, 0.0, "change of the mass each second (arm only)"},
                   {"levelling",
                    "",
                    0.0,
                    2.0,
                    0.0,
                    "0: never; 1: before and after a change; 2: settles",
                    {Role::choice, 0, 2, 3}},
                   {"centre_s",
                    "s",
                    0.0,
                    1e5,
                    30.0,
                    "time of the fastest change, for levelling 1",
                    {Role::shape, 3, 40, 4, Scale::absolute, true}},
                   {"width_s",
                    "s",
                    0.01,
                    1e5,
                    5.0,
                    "time constant, for levelling 1 and 2",
                    {Role::shape, 2, 32, 4, Scale::absolute, true}}},
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
    if (parameter == kCentre) return form() == Form::change;
    return parameter != kWidth || form() != Form::linear;
  }
  LinearElement linearise(const OperatingPoint& point, const PortBase&) const override {
    return {.stiffness_N_per_m = value(kStiffness) * elapsed(point.t_s),
            .damping_Ns_per_m = value(kDamping) * elapsed(point.t_s),
            .mass_kg = added_mass_kg(point.t_s)};
  }

 private:
  enum class Form { linear, change, settling };
  Form form() const {
    return value(kLevelling) > 1.5 ? Form::settling : value(kLevelling) > 0.5 ? Form::change : Form::linear;
  }
  /// g(t), s: its slope is 1 where the change is fastest.
  double elapsed(double t_s) const {
    if (form() == Form::linear) return t_s;
    const double width = value(kWidth), centre = value(kCentre);
    if (form() == Form::settling) return -width * std::expm1(-t_s / width);
    const auto logistic = [](double u) { return 1 / (1 + std::exp(-u)); };
    return 4 * width * (logistic((t_s - centre) / width) - logistic(-centre / width));
  }
};

}  // namespace

EffectType parameter_drift_effect() {
  return effect_entry<ParameterDrift>(kInfo);
}

}  // namespace handloop::models
