#include <cmath>

#include "models/effects/entry.h"

namespace handloop::models {
namespace {

const EffectInfo kInfo{
    .name = "gravity",
    .title = "Gravity",
    .equation = "F = sine_N sin(x / length_m) + cosine_N cos(x / length_m)",
    .source = "weight of a link of lever length_m; for a rotary axis length_m = 1 and x is its angle",
    .fingerprint = "constant force that turns with position",
    .experiment = "the same trial at a second posture",
    .places = {Place::arm, Place::joint},
    .parameters = {{"sine_N", "N", -1e4, 1e4, 0.0, "weight (or its greatest moment) where x = 0 hangs straight down"},
                   {"cosine_N", "N", -1e4, 1e4, 1.0, "weight (or its greatest moment) where x = 0 is level"},
                   {"length_m", "m", 0.01, 1e3, 0.3, "lever on which the weight swings", {Role::choice, 1, 1, 1}}},
    .search_places = {Place::arm},
};

class Gravity final : public Effect {
 public:
  Gravity(Place place, std::span<const double> values) : Effect(kInfo, place, values) {}
  double force_N(const PortMotion& motion, const PortBase&, std::span<const double>) const override {
    const double angle = motion.x_m / value(2);
    return value(0) * std::sin(angle) + value(1) * std::cos(angle);
  }
  LinearElement linearise(const OperatingPoint& point, const PortBase&) const override {
    const double angle = point.x_mean_m / value(2), spread = point.x_rms_m / value(2);
    return {.stiffness_N_per_m = std::exp(-0.5 * spread * spread) / value(2) *
                                 (value(0) * std::cos(angle) - value(1) * std::sin(angle))};
  }
};

}  // namespace

EffectType gravity_effect() {
  return effect_entry<Gravity>(kInfo);
}

}  // namespace handloop::models
