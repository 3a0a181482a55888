#include <algorithm>
#include <cmath>

#include "models/effects/entry.h"

namespace handloop::models {
namespace {

const EffectInfo kInfo{
    .name = "backlash",
    .title = "Backlash of the grasp",
    .equation = "F = -k clamp(x, -gap_m/2, gap_m/2): within the gap the spring beside it does not act",
    .source = "dead zone; Nordin and Gutman, Automatica 38 (2002) 1633",
    .fingerprint = "no stiffness near zero extension of the grasp",
    .experiment = "repeat at a fifth of the force: the gap takes all of the motion",
    .places = {Place::grasp, Place::arm},
    .parameters =
        {{"gap_m", "m", 0.0, 0.1, 0.001, "whole width of the dead zone", {Role::shape, 0.1, 3, 5, Scale::position}}},
    .search_places = {Place::grasp, Place::arm},
};

class Backlash final : public Effect {
 public:
  Backlash(Place place, std::span<const double> values) : Effect(kInfo, place, values) {}
  double force_N(const PortMotion& motion, const PortBase& base, std::span<const double>) const override {
    const double half = 0.5 * value(0);
    return -base.stiffness_N_per_m * std::clamp(motion.x_m, -half, half);
  }
  LinearElement linearise(const OperatingPoint& point, const PortBase& base) const override {
    const double inside = std::erf(0.5 * value(0) / (point.x_rms_m * std::sqrt(2.0)));
    return {.stiffness_N_per_m = -base.stiffness_N_per_m * inside};
  }
};

}  // namespace

EffectType backlash_effect() {
  return effect_entry<Backlash>(kInfo);
}

}  // namespace handloop::models
