#include <algorithm>
#include <cmath>

#include "control/loop_function.h"
#include "control/margins.h"

namespace handloop::control {
namespace {

/// Numerator + denominator of 1 + L and its slope, at a point delta anywhere in the plane.
struct Characteristic {
  const LoopFunction& loop;

  /// p / p'.
  Cx newton(Cx delta) const {
    const auto& n = loop.plant.numerator;
    Cx num = n[3], num_slope{};
    for (std::size_t i = 3; i-- > 0;) {
      num_slope = num_slope * delta + num;
      num = num * delta + Cx(n[i]);
    }
    const Cx wall = Cx(loop.wall_c1) * delta + Cx(loop.wall_c0);
    Cx value = num * wall, slope = num_slope * wall + num * Cx(loop.wall_c1);
    Cx den = delta + Cx(loop.one_minus_a), den_slope(1);
    const auto multiply = [&](Cx factor, Cx factor_slope) {
      den_slope = den_slope * factor + den * factor_slope;
      den = den * factor;
    };
    for (int i = 0; i < loop.plant.section_count; ++i) {
      const auto& s = loop.plant.sections[static_cast<std::size_t>(i)];
      multiply((delta + Cx(s.a1)) * delta + Cx(s.a0), delta + delta + Cx(s.a1));
    }
    const Cx z = delta + Cx(1);
    for (int i = 0; i < loop.delay; ++i) multiply(z, Cx(1));
    value = value + den, slope = slope + den_slope;
    if (value.norm() == 0) return {};
    return value / slope;
  }
};

}  // namespace

double ClosedLoopPoles::rho() const {
  double largest = 0;
  for (int i = 0; i < count; ++i) largest = std::max(largest, std::abs(z[static_cast<std::size_t>(i)]));
  return largest;
}

ClosedLoopPoles closed_loop_poles(const SampledPlant& plant, const LoopTiming& timing,
                                  const WallGains& gains) noexcept {
  const LoopFunction loop(plant, timing, gains);
  std::array<Cx, 5 + kMaxDelaySamples> root;
  int count = 0;
  const auto start = [&](Cx delta) { root[static_cast<std::size_t>(count++)] = delta; };
  // the poles of the open loop are where the closed loop's start
  for (int i = 0; i < plant.section_count; ++i) {
    const auto& s = plant.sections[static_cast<std::size_t>(i)];
    const double c = -s.a1 / 2, D = c * c - s.a0;
    if (D < 0) {
      const double w = std::sqrt(-D);
      start({c, w}), start({c, -w});
    } else {
      const double big = c - std::sqrt(D);
      start(big), start(big != 0 ? s.a0 / big : 0.0);
    }
  }
  start(-loop.one_minus_a);
  for (int i = 0; i < loop.delay; ++i) start(-1.0);

  ClosedLoopPoles poles;
  poles.count = count;
  if (!loop.is_zero()) {
    // no two may start together, nor all on a line of symmetry
    for (int i = 0; i < count; ++i) {
      const double angle = 0.7 + 2.4 * i, radius = i > 2 * plant.section_count ? 0.3 : 0.02;
      root[static_cast<std::size_t>(i)] =
          root[static_cast<std::size_t>(i)] + Cx(radius * std::cos(angle), radius * std::sin(angle));
    }
    // Ehrlich and Aberth: Newton's step at every root, corrected for the others
    const Characteristic characteristic{loop};
    std::array<bool, 5 + kMaxDelaySamples> done{};
    int left = count;
    for (int sweep = 0; sweep < 200 && left > 0; ++sweep) {
      for (int i = 0; i < count; ++i) {
        if (done[static_cast<std::size_t>(i)]) continue;
        const Cx here = root[static_cast<std::size_t>(i)];
        const Cx newton = characteristic.newton(here);
        Cx repulsion{};
        for (int j = 0; j < count; ++j) {
          if (j == i) continue;
          const Cx gap = here - root[static_cast<std::size_t>(j)];
          const double size = gap.norm();
          if (size > 0) repulsion = repulsion + Cx(gap.re / size, -gap.im / size);
        }
        const Cx step = newton / (Cx(1) - newton * repulsion);
        if (!(step.norm() < 1e6)) {  // at a stationary point: step aside
          root[static_cast<std::size_t>(i)] = here + Cx(0.01 * (i + 1), 0.013);
          continue;
        }
        root[static_cast<std::size_t>(i)] = here - step;
        if (step.norm() < 1e-24) done[static_cast<std::size_t>(i)] = true, --left;
      }
    }
  }
  for (int i = 0; i < count; ++i) {
    const Cx delta = root[static_cast<std::size_t>(i)];
    poles.z[static_cast<std::size_t>(i)] = {1 + delta.re, delta.im};
  }
  return poles;
}

}  // namespace handloop::control
