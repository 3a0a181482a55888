#include "models/effects/entry.h"

namespace handloop::models {
namespace {

const EffectInfo kInfo{
    .name = "cubic_stiffness",
    .title = "Cubic stiffness",
    .equation = "F = coefficient_N_per_m3 x^3",
    .source = "G. Duffing 1918; hardening where positive, softening where negative",
    .fingerprint = "odd force that grows with the cube of displacement",
    .experiment = "repeat at twice the force: its share grows fourfold",
    .places = {Place::arm, Place::grasp, Place::joint},
    .parameters = {{"coefficient_N_per_m3", "N/m^3", -1e12, 1e12, 1e6, "force at 1 m, were it still cubic there"}},
    .search_places = {Place::arm, Place::grasp},
};

class CubicStiffness final : public Effect {
 public:
  CubicStiffness(Place place, std::span<const double> values) : Effect(kInfo, place, values) {}
  double force_N(const PortMotion& motion, const PortBase&, std::span<const double>) const override {
    return value(0) * motion.x_m * motion.x_m * motion.x_m;
  }
  LinearElement linearise(const OperatingPoint& point, const PortBase&) const override {
    return {.stiffness_N_per_m = 3 * value(0) * (point.x_rms_m * point.x_rms_m + point.x_mean_m * point.x_mean_m)};
  }
};

}  // namespace

EffectType cubic_stiffness_effect() {
  return effect_entry<CubicStiffness>(kInfo);
}

}  // namespace handloop::models
