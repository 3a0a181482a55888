#include <cmath>

#include "models/effects/entry.h"

namespace handloop::models {
namespace {

const EffectInfo kInfo{
    .name = "gravity",
    .title = "Gravity",
    .equation = "F = force_N sin(x / length_m + phase_rad)",
    .source = "weight of a link of lever length_m; for a rotary axis length_m = 1 and x is its angle",
    .places = {Place::arm, Place::joint},
    .parameters = {{"force_N", "N", 0.0, 1e4, 1.0, "weight, or its greatest moment"},
                   {"length_m", "m", 0.01, 1e3, 0.3, "lever on which the weight swings", true},
                   {"phase_rad", "rad", -10.0, 10.0, 0.0, "angle from the vertical at x = 0"}},
};

class Gravity final : public Effect {
 public:
  Gravity(Place place, std::span<const double> values) : Effect(kInfo, place, values) {}
  double force_N(const PortMotion& motion, const PortBase&, std::span<const double>) const override {
    return value(0) * std::sin(motion.x_m / value(1) + value(2));
  }
  LinearElement linearise(const OperatingPoint& point, const PortBase&) const override {
    return {.stiffness_N_per_m = value(0) / value(1) * std::cos(point.x_mean_m / value(1) + value(2))};
  }
};

}  // namespace

EffectType gravity_effect() {
  return effect_entry<Gravity>(kInfo);
}

}  // namespace handloop::models
