#include <cmath>
#include <numbers>

#include "models/effects/entry.h"

namespace handloop::models {
namespace {

const EffectInfo kInfo{
    .name = "position_ripple",
    .title = "Position ripple (cogging)",
    .equation = "F = amplitude_N sin(2 pi x / period_m + phase_rad)",
    .source = "cogging of motors, ripple of capstans and gears; Mohan, Electric Drives, ch. 10",
    .places = {Place::arm, Place::joint},
    .parameters = {{"amplitude_N", "N", 0.0, 1e4, 0.1, "of the ripple"},
                   {"period_m", "m", 1e-5, 10.0, 0.004, "after which it repeats"},
                   {"phase_rad", "rad", -10.0, 10.0, 0.0, "at x = 0"}},
};

class PositionRipple final : public Effect {
 public:
  PositionRipple(Place place, std::span<const double> values) : Effect(kInfo, place, values) {}
  double force_N(const PortMotion& motion, const PortBase&, std::span<const double>) const override {
    return law(motion.x_m);
  }
  LinearElement linearise(const OperatingPoint& point, const PortBase&) const override {
    // Gelb and Vander Velde 1968: the mean slope of a sine under Gaussian motion
    const double k = 2 * std::numbers::pi / value(1), spread = k * point.x_rms_m;
    return {.stiffness_N_per_m =
                value(0) * k * std::exp(-0.5 * spread * spread) * std::cos(k * point.x_mean_m + value(2))};
  }

 private:
  double law(double x) const { return value(0) * std::sin(2 * std::numbers::pi * x / value(1) + value(2)); }
};

}  // namespace

EffectType position_ripple_effect() {
  return effect_entry<PositionRipple>(kInfo);
}

}  // namespace handloop::models
