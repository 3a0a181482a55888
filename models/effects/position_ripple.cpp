#include <cmath>
#include <numbers>

#include "models/effects/entry.h"

namespace handloop::models {
namespace {

const EffectInfo kInfo{
    .name = "position_ripple",
    .title = "Position ripple (cogging)",
    .equation = "F = sine_N sin(2 pi x / period_m) + cosine_N cos(2 pi x / period_m)",
    .source = "cogging of motors, ripple of capstans and gears; Mohan, Electric Drives, ch. 10",
    .fingerprint = "force periodic in position",
    .experiment = "slow sweep over several periods",
    .places = {Place::arm, Place::joint},
    .parameters =
        {{"sine_N", "N", -1e4, 1e4, 0.1, "odd part of the ripple"},
         {"cosine_N", "N", -1e4, 1e4, 0.0, "even part of the ripple"},
         {"period_m", "m", 1e-5, 10.0, 0.004, "after which it repeats", {Role::shape, 0.2, 3, 90, Scale::position}}},
    .search_places = {Place::arm, Place::joint},
};

class PositionRipple final : public Effect {
 public:
  PositionRipple(Place place, std::span<const double> values) : Effect(kInfo, place, values) {}
  double force_N(const PortMotion& motion, const PortBase&, std::span<const double>) const override {
    const double angle = wavenumber() * motion.x_m;
    return value(0) * std::sin(angle) + value(1) * std::cos(angle);
  }
  LinearElement linearise(const OperatingPoint& point, const PortBase&) const override {
    // Gelb and Vander Velde 1968: the mean slope of a sine under Gaussian motion
    const double k = wavenumber(), spread = k * point.x_rms_m, angle = k * point.x_mean_m;
    return {.stiffness_N_per_m =
                k * std::exp(-0.5 * spread * spread) * (value(0) * std::cos(angle) - value(1) * std::sin(angle))};
  }

 private:
  double wavenumber() const { return 2 * std::numbers::pi / value(2); }
};

}  // namespace

EffectType position_ripple_effect() {
  return effect_entry<PositionRipple>(kInfo);
}

}  // namespace handloop::models
