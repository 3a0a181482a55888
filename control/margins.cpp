#include "control/margins.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "control/circle_polynomials.h"
#include "control/loop_function.h"
#include "control/margin_collector.h"
#include "control/scan.h"

namespace handloop::control {
namespace {

constexpr double kPi = std::numbers::pi;

double angle_of(double y) {
  return 2 * std::asin(std::min(1.0, std::sqrt(y) / 2));
}

/// Newton's method on a function of the angle that returns value and slope; keeps the best point.
template <class Function>
double sharpen(double theta, Function&& value_and_slope) {
  double best = theta, best_size = Margins::kInfinity;
  for (int i = 0; i < 6; ++i) {
    const auto [value, slope] = value_and_slope(theta);
    const double size = std::abs(value);
    if (!(size < best_size)) break;
    best = theta, best_size = size;
    const double step = value / slope;
    if (!(std::abs(step) < 0.05 * theta)) break;
    theta = std::min(theta - step, kPi);
    if (std::abs(step) < 1e-16 * theta) break;
  }
  return best;
}

/// The secant method, for functions whose slope is not at hand.
template <class Function>
double sharpen_by_secant(double theta, Function&& value_of) {
  double a = theta, fa = value_of(a), b = theta < 0.5 * kPi ? theta * (1 + 1e-6) : theta * (1 - 1e-6), fb = value_of(b);
  for (int i = 0; i < 12; ++i) {
    if (std::abs(fb) > std::abs(fa)) std::swap(a, b), std::swap(fa, fb);
    if (fb == 0 || fa == fb) break;
    const double step = fb * (b - a) / (fb - fa);
    if (!(std::abs(step) < 0.05 * theta)) break;
    a = b, fa = fb;
    b = std::min(b - step, kPi);
    if (std::abs(step) < 1e-15 * b) break;
    fb = value_of(b);
  }
  return b;
}

struct Slope {
  Cx loop, to_angle;  ///< L and dL/dtheta over L
};

Slope slope_at(const LoopFunction& loop, double theta) {
  const Cx delta = LoopFunction::delta_at(theta);
  const auto v = loop.at<true>(delta);
  const Cx z = delta + Cx(1);
  return {v.loop(), Cx(-z.im, z.re) * v.log_slope};
}

/// All margins by the roots of the circle polynomials.
void margins_by_roots(const LoopFunction& loop, MarginCollector& collector) {
  const double T = loop.plant.sample_time_s;
  const CirclePolynomials polynomials(loop);
  const auto gain_roots = roots_in(polynomials.gain, 4.0);
  for (int i = 0; i < gain_roots.count; ++i) {
    const double theta = sharpen(angle_of(gain_roots.x[static_cast<std::size_t>(i)]), [&](double at) {
      const auto [L, slope] = slope_at(loop, at);
      return std::pair(0.5 * std::log(L.norm()), slope.re);
    });
    collector.gain_crossing(slope_at(loop, theta).loop.std(), theta / T);
  }
  const auto phase_roots = roots_in(polynomials.phase, 4.0);
  for (int i = 0; i < phase_roots.count; ++i) {
    const double start = angle_of(phase_roots.x[static_cast<std::size_t>(i)]);
    if (slope_at(loop, start).loop.re >= 0) continue;
    const double theta = sharpen(start, [&](double at) {
      const auto [L, slope] = slope_at(loop, at);
      return std::pair((-L).arg(), slope.im);
    });
    collector.phase_crossing(slope_at(loop, theta).loop.re, theta / T);
  }
  for (const Cx delta : {Cx(0), Cx(-2)}) {
    const auto v = loop.at<false>(delta);
    const double frequency = delta.re == 0 ? 0.0 : kPi / T;
    if (v.denominator.norm() > 0) collector.phase_crossing(v.loop().re, frequency);
    collector.distance(v.numerator.std(), v.denominator.std(), frequency);
  }
  const auto sharpen_peaks = [&](const CirclePolynomial& stationary, auto&& function, auto&& worst_of) {
    const auto candidates = roots_in(stationary, 4.0);
    double worst = Margins::kInfinity;
    std::array<double, kCirclePolynomialCapacity> angle{}, size{};
    for (int i = 0; i < candidates.count; ++i) {
      const auto k = static_cast<std::size_t>(i);
      angle[k] = angle_of(candidates.x[k]);
      const auto v = loop.at<false>(LoopFunction::delta_at(angle[k]));
      collector.distance(v.numerator.std(), v.denominator.std(), angle[k] / T);
      size[k] = worst_of(v);
      worst = std::min(worst, size[k]);
    }
    for (int i = 0; i < candidates.count; ++i) {
      const auto k = static_cast<std::size_t>(i);
      if (size[k] > 4 * worst) continue;  // stationary values are known to second order already
      const double theta = sharpen_by_secant(angle[k], function);
      const auto v = loop.at<false>(LoopFunction::delta_at(theta));
      collector.distance(v.numerator.std(), v.denominator.std(), theta / T);
    }
  };
  sharpen_peaks(
      polynomials.modulus,
      [&](double at) {
        const auto [L, slope] = slope_at(loop, at);
        return (L * slope * (Cx(1) + L).conj()).re;
      },
      [](const LoopFunction::Value& v) { return (v.numerator + v.denominator).norm() / v.denominator.norm(); });
  sharpen_peaks(
      polynomials.disk,
      [&](double at) {
        const auto [L, slope] = slope_at(loop, at);
        return (L * slope * (Cx(1) - L * L).conj()).re;
      },
      [](const LoopFunction::Value& v) {
        return (v.numerator + v.denominator).norm() / (v.denominator - v.numerator).norm();
      });
}

}  // namespace

DiskGuarantee disk_guarantee(double alpha, double skew) {
  const double a = alpha, s = skew;
  DiskGuarantee g;
  g.gain_low = std::max(0.0, (2 - a * (1 - s)) / (2 + a * (1 + s)));
  const double rest = 2 - a * (1 + s);
  g.gain_high = rest > 0 ? (2 + a * (1 - s)) / rest : Margins::kInfinity;
  const double low = (2 - a * (1 - s)) / (2 + a * (1 + s)), high = (2 + a * (1 - s)) / rest;
  // a circle through real gains low and high meets the unit circle where cos(phase) = (1 + low high)/(low + high)
  const double cosine = rest != 0 ? (1 + low * high) / (low + high) : low;
  g.phase_deg = cosine <= -1 ? 180.0 : cosine >= 1 ? 0.0 : std::acos(cosine) * 180 / kPi;
  return g;
}

Margins evaluate(const SampledPlant& plant, const LoopTiming& timing, const WallGains& gains) noexcept {
  Margins margins;
  margins.rho = closed_loop_poles(plant, timing, gains).rho();
  margins.stable = margins.rho < 1;
  if (!margins.stable) return margins;
  const LoopFunction loop(plant, timing, gains);
  MarginCollector collector(margins);
  if (loop.is_zero()) {
    collector.distance(0.0, 1.0, 0.0);
  } else if (loop.delay <= kMaxPolynomialDelay) {
    margins_by_roots(loop, collector);
  } else {
    scan_sampled_loop(loop, closed_loop_poles(plant, timing, gains), collector);
  }
  collector.finish();
  return margins;
}

Margins evaluate(const Loop& loop) {
  require_valid(loop);
  return evaluate(sample_plant(loop.plant, loop.timing.sample_time_s), loop.timing, loop.gains);
}

LoopResponse loop_response(const SampledPlant& plant, const LoopTiming& timing, const WallGains& gains,
                           double frequency_rad_per_s) noexcept {
  const LoopFunction loop(plant, timing, gains);
  const Cx delta = LoopFunction::delta_at(frequency_rad_per_s * timing.sample_time_s);
  const auto v = loop.at<false>(delta);
  LoopResponse r;
  r.plant = plant(delta.std());
  r.wall = ((Cx(loop.wall_c1) * delta + Cx(loop.wall_c0)) / (delta + Cx(loop.one_minus_a))).std();
  r.loop = v.loop().std();
  r.sensitivity = (v.denominator / (v.denominator + v.numerator)).std();
  r.complementary_sensitivity = (v.numerator / (v.denominator + v.numerator)).std();
  return r;
}

}  // namespace handloop::control
