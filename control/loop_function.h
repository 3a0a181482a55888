#pragma once

#include <array>
#include <cmath>

#include "control/loop.h"
#include "control/plain_complex.h"
#include "control/sampled_plant.h"

/// The loop transfer of a sampled wall in factored form: what margins and poles evaluate in their inner loops.
namespace handloop::control {

/// L = plant numerator * (c1 delta + c0) / (sections * (delta + 1 - a) * (1 + delta)^d).
struct LoopFunction {
  const SampledPlant& plant;
  double wall_c1, wall_c0;  ///< numerator of C in delta: K (delta + 1 - a) + B (1-a)/T delta
  double one_minus_a;
  int delay;

  LoopFunction(const SampledPlant& sampled, const LoopTiming& timing, const WallGains& gains)
      : plant(sampled), delay(timing.delay_samples) {
    one_minus_a = -std::expm1(-2 * std::numbers::pi * timing.cutoff_Hz * timing.sample_time_s);
    wall_c1 = gains.stiffness_N_per_m + gains.damping_Ns_per_m * one_minus_a / timing.sample_time_s;
    wall_c0 = gains.stiffness_N_per_m * one_minus_a;
  }

  bool is_zero() const { return wall_c1 == 0 && wall_c0 == 0; }

  /// Numerator and denominator of L and, where asked, their logarithmic derivatives to z.
  struct Value {
    Cx numerator, denominator;  ///< with z^d in the denominator
    Cx log_slope;               ///< d ln L / dz
    Cx loop() const { return numerator / denominator; }
  };

  template <bool WithSlope>
  Value at(Cx delta) const {
    const auto& n = plant.numerator;
    Cx num = n[3], slope{};
    for (std::size_t i = 3; i-- > 0;) {
      if constexpr (WithSlope) slope = slope * delta + num;
      num = num * delta + Cx(n[i]);
    }
    Value v;
    const Cx wall = Cx(wall_c1) * delta + Cx(wall_c0), filter = delta + Cx(one_minus_a), z = delta + Cx(1);
    v.numerator = num * wall;
    v.denominator = filter;
    if constexpr (WithSlope) v.log_slope = slope / num + Cx(wall_c1) / wall - Cx(1) / filter;
    for (int i = 0; i < plant.section_count; ++i) {
      const auto& s = plant.sections[static_cast<std::size_t>(i)];
      const Cx q = (delta + Cx(s.a1)) * delta + Cx(s.a0);
      v.denominator = v.denominator * q;
      if constexpr (WithSlope) v.log_slope = v.log_slope - (delta + delta + Cx(s.a1)) / q;
    }
    for (int i = 0; i < delay; ++i) v.denominator = v.denominator * z;
    if constexpr (WithSlope) {
      if (delay > 0) v.log_slope = v.log_slope - Cx(delay) / z;
    }
    return v;
  }

  /// delta = e^{j theta} - 1 without cancellation.
  static Cx delta_at(double theta) {
    const double s = std::sin(theta / 2), c = std::cos(theta / 2);
    return {-2 * s * s, 2 * s * c};
  }
};

}  // namespace handloop::control
