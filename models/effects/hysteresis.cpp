#include <cmath>
#include <numbers>

#include "models/effects/entry.h"

namespace handloop::models {
namespace {

const EffectInfo kInfo{
    .name = "hysteresis",
    .title = "Hysteresis (Bouc-Wen)",
    .equation = "F = force_N z, z' = (v - shape |v| |z|^(exponent-1) z + (shape - 1) v |z|^exponent) / yield_m",
    .source = "R. Bouc 1967, Y.-K. Wen 1976, normalised by Ikhouane and Rodellar (2007), eq. (2.24)",
    .fingerprint = "loop in force over displacement that does not depend on speed",
    .experiment = "slow triangles of displacement with inner loops",
    .places = {Place::arm, Place::grasp, Place::joint},
    .parameters = {{"force_N", "N", 0.0, 1e4, 0.2, "force at which it yields"},
                   {"yield_m",
                    "m",
                    1e-6,
                    1.0,
                    1e-3,
                    "displacement to get there at the initial stiffness",
                    {Role::shape, 0.05, 2, 5, Scale::position}},
                   {"shape",
                    "",
                    0.5,
                    1.5,
                    0.5,
                    "0.5: unloads along the initial stiffness",
                    {Role::shape, 0.5, 0.7, 1, Scale::absolute, true}},
                   {"exponent", "", 1.0, 5.0, 1.0, "sharpness of the knee", {Role::choice, 1, 2, 2, Scale::absolute}}},
    .search_places = {Place::arm, Place::grasp},
};

class Hysteresis final : public Effect {
 public:
  Hysteresis(Place place, std::span<const double> values) : Effect(kInfo, place, values) {}
  std::size_t state_count() const override { return 1; }
  double force_N(const PortMotion&, const PortBase&, std::span<const double> states) const override {
    return value(0) * states[0];
  }
  void state_rates(const PortMotion& motion, const PortBase&, std::span<const double> states,
                   std::span<double> rates) const override {
    rates[0] = rate(motion.v_m_per_s, states[0]);
  }
  LinearElement linearise(const OperatingPoint& point, const PortBase&) const override {
    // First harmonic over the second of two cycles of a sine of the same power; rate-independent, so any speed will do.
    constexpr int kSteps = 2000;
    const double amplitude = std::numbers::sqrt2 * point.x_rms_m;
    const double step = 2 * std::numbers::pi / kSteps;
    double z = 0, in_phase = 0, quadrature = 0;
    for (int i = 0; i < 2 * kSteps; ++i) {
      const double angle = (i + 0.5) * step;
      z += step * rate(amplitude * std::cos(angle), z);
      if (i >= kSteps) {
        in_phase += z * std::sin(angle + 0.5 * step);
        quadrature += z * std::cos(angle + 0.5 * step);
      }
    }
    const double scale = value(0) * step / (std::numbers::pi * amplitude);
    return {.stiffness_N_per_m = scale * in_phase,
            .damping_Ns_per_m = scale * quadrature * point.x_rms_m / point.v_rms_m_per_s};
  }

 private:
  double rate(double v, double z) const {
    const double shape = value(2), exponent = value(3);
    const double magnitude = exponent == 1.0 ? std::abs(z) : std::pow(std::abs(z), exponent);
    return (v - shape * std::abs(v) * std::copysign(magnitude, z) + (shape - 1) * v * magnitude) / value(1);
  }
};

}  // namespace

EffectType hysteresis_effect() {
  return effect_entry<Hysteresis>(kInfo);
}

}  // namespace handloop::models
