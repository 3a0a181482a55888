#include <cmath>

#include "models/effects/entry.h"

namespace handloop::models {
namespace {

const EffectInfo kInfo{
    .name = "asymmetric_stiffness",
    .title = "Asymmetric stiffness",
    .equation = "F = 1/2 difference_N_per_m |x|: stiffer by the difference for x > 0 than for x < 0",
    .source = "flexors and extensors differ; even part of a piecewise linear spring",
    .fingerprint = "even force: stiffer to one side",
    .experiment = "steps to both sides of the rest position",
    .places = {Place::arm, Place::grasp, Place::joint},
    .parameters = {{"difference_N_per_m", "N/m", -1e6, 1e6, 50.0, "stiffness for x > 0 less that for x < 0"}},
    .search_places = {Place::arm, Place::grasp},
};

class AsymmetricStiffness final : public Effect {
 public:
  AsymmetricStiffness(Place place, std::span<const double> values) : Effect(kInfo, place, values) {}
  double force_N(const PortMotion& motion, const PortBase&, std::span<const double>) const override {
    return 0.5 * value(0) * std::abs(motion.x_m);
  }
  LinearElement linearise(const OperatingPoint& point, const PortBase&) const override {
    // even about zero: only a mean displacement makes a linear part of it
    const double share = std::erf(point.x_mean_m / (point.x_rms_m * std::sqrt(2.0)));
    return {.stiffness_N_per_m = 0.5 * value(0) * share};
  }
};

}  // namespace

EffectType asymmetric_stiffness_effect() {
  return effect_entry<AsymmetricStiffness>(kInfo);
}

}  // namespace handloop::models
