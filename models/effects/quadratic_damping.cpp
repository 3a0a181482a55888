#include <cmath>
#include <numbers>

#include "models/effects/entry.h"

namespace handloop::models {
namespace {

const EffectInfo kInfo{
    .name = "quadratic_damping",
    .title = "Quadratic damping",
    .equation = "F = coefficient_Ns2_per_m2 |v| v",
    .source = "drag at high Reynolds number; Gelb and Vander Velde 1968, table of random-input describing functions",
    .fingerprint = "odd force that grows with the square of the velocity",
    .experiment = "repeat at twice the force: its share doubles",
    .places = {Place::arm, Place::joint, Place::grasp},
    .parameters = {{"coefficient_Ns2_per_m2", "Ns^2/m^2", 0.0, 1e6, 10.0, "force at 1 m/s"}},
    .search_places = {Place::arm},
};

class QuadraticDamping final : public Effect {
 public:
  QuadraticDamping(Place place, std::span<const double> values) : Effect(kInfo, place, values) {}
  double force_N(const PortMotion& motion, const PortBase&, std::span<const double>) const override {
    return value(0) * std::abs(motion.v_m_per_s) * motion.v_m_per_s;
  }
  LinearElement linearise(const OperatingPoint& point, const PortBase&) const override {
    // E|u|^3 = 2 sqrt(2/pi) for unit normal u
    return {.damping_Ns_per_m = value(0) * point.v_rms_m_per_s * 2 * std::sqrt(2 / std::numbers::pi)};
  }
};

}  // namespace

EffectType quadratic_damping_effect() {
  return effect_entry<QuadraticDamping>(kInfo);
}

}  // namespace handloop::models
