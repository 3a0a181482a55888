#pragma once

#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <complex>
#include <span>
#include <utility>

#include "control/loop_function.h"
#include "control/margin_collector.h"
#include "control/margins.h"

/// Margins of a loop known only through its frequency response: found between the points of a grid that crowds where
/// poles are near the axis, then sharpened to rounding. For loops whose crossings are not roots of small polynomials.
namespace handloop::control {

/// L at one frequency as a quotient, so that poles and zeros on the axis can be told.
struct ResponsePoint {
  std::complex<double> numerator, denominator;
};

namespace detail {

/// The root of f between a and b, signs known to differ.
template <class F>
double root_between(F&& f, double a, double fa, double b, double fb) {
  for (int i = 0; i < 200; ++i) {
    double x = std::isfinite(fa) && std::isfinite(fb) && i % 3 != 2 ? (a * fb - b * fa) / (fb - fa) : 0.5 * (a + b);
    if (!(x > std::min(a, b) && x < std::max(a, b))) x = 0.5 * (a + b);
    const double fx = f(x);
    if (fx == 0) return x;
    if ((fx < 0) == (fb < 0)) {
      b = x, fb = fx, fa *= 0.5;  // Illinois: the end that stays counts half
      if (std::isfinite(fa) && i % 3 == 2) fa = f(a);
    } else {
      a = x, fa = fx, fb *= 0.5;
      if (std::isfinite(fb) && i % 3 == 2) fb = f(b);
    }
    if (std::abs(b - a) <= 2e-16 * std::abs(b)) break;
  }
  return std::abs(fa) < std::abs(fb) ? a : b;
}

/// Every root of f between neighbours of the grid; also pairs of roots between three points where f turns short of
/// zero.
template <class F, class Found>
void roots_on_grid(std::span<const double> grid, F&& f, Found&& found) {
  double before = 0, before_x = 0, last = f(grid[0]), last_x = grid[0];
  for (std::size_t i = 1; i < grid.size(); ++i) {
    const double x = grid[i], here = f(x);
    if (last == 0) found(last_x);
    if (last * here < 0) {
      found(root_between(f, last_x, last, x, here));
    } else if (i > 1 && std::abs(last) < std::abs(before) && std::abs(last) <= std::abs(here) && before * last > 0 &&
               last * here > 0) {
      const double sign = last < 0 ? -1 : 1;
      std::uintmax_t most = 60;
      const auto [at, value] =
          boost::math::tools::brent_find_minima([&](double w) { return sign * f(w); }, before_x, x, 40, most);
      if (value < 0) {
        found(root_between(f, before_x, before, at, sign * value));
        found(root_between(f, at, sign * value, x, here));
      }
    }
    before = last, before_x = last_x, last = here, last_x = x;
  }
  if (last == 0) found(last_x);
}

/// Every local minimum of f on the grid, sharpened.
template <class F, class Found>
void minima_on_grid(std::span<const double> grid, F&& f, Found&& found) {
  for (std::size_t i = 1; i + 1 < grid.size(); ++i) {
    const double here = f(grid[i]);
    if (!(here <= f(grid[i - 1]) && here <= f(grid[i + 1]))) continue;
    std::uintmax_t most = 200;
    auto [x, value] = boost::math::tools::brent_find_minima(f, grid[i - 1], grid[i + 1], 52, most);
    // near instability the minimum is far narrower than its own square root of rounding: the vertex of parabolas
    // through points beyond it finds it to the last digits
    for (const double reach : {1e-5, 1e-6, 1e-7, 1e-8}) {
      const double h = reach * x, left = f(x - h), right = f(x + h), bend = left - 2 * value + right;
      if (!(bend > 0)) continue;
      const double vertex = x + 0.5 * h * (left - right) / bend, there = f(vertex);
      if (there < value) x = vertex, value = there;
    }
    found(x);
  }
}

}  // namespace detail

/// Collects the margins of response(w) -> ResponsePoint over a rising grid of positive frequencies in rad/s.
template <class Response>
void scan_response(std::span<const double> grid, Response&& response, MarginCollector& collector) {
  const auto loop = [&](double w) {
    const ResponsePoint p = response(w);
    return p.numerator / p.denominator;
  };
  if (grid.size() < 3) return;
  detail::roots_on_grid(
      grid,
      [&](double w) {
        const ResponsePoint p = response(w);
        const double n = std::norm(p.numerator), d = std::norm(p.denominator);
        return std::clamp(std::log(n / d), -1e3, 1e3);
      },
      [&](double w) { collector.gain_crossing(loop(w), w); });
  detail::roots_on_grid(
      grid,
      [&](double w) {
        const ResponsePoint p = response(w);
        const auto e = p.numerator * std::conj(p.denominator);
        const double size = std::abs(e);
        return size > 0 ? e.imag() / size : 0.0;
      },
      [&](double w) {
        const auto L = loop(w);
        if (std::abs(L.imag()) < 1e-3 * std::abs(L.real())) collector.phase_crossing(L.real(), w);
      });
  const auto collect = [&](double w) {
    const ResponsePoint p = response(w);
    collector.distance(p.numerator, p.denominator, w);
  };
  collect(grid.front());
  collect(grid.back());
  detail::minima_on_grid(
      grid,
      [&](double w) {
        const ResponsePoint p = response(w);
        return std::norm(p.numerator + p.denominator) / std::max(std::norm(p.denominator), 1e-300);
      },
      collect);
  detail::minima_on_grid(
      grid,
      [&](double w) {
        const ResponsePoint p = response(w);
        return std::norm(p.numerator + p.denominator) / std::max(std::norm(p.denominator - p.numerator), 1e-300);
      },
      collect);
}

/// Collects grid points: a base of evenly and logarithmically spaced ones, and a crowd about each pole near the axis.
/// Fixed capacity, no heap.
class FrequencyGrid {
 public:
  void add(double w) {
    if (w > lowest_ && w < highest_ && count_ < points_.size()) points_[count_++] = w;
  }
  FrequencyGrid(double lowest, double highest) : lowest_(lowest), highest_(highest) {
    points_[count_++] = lowest;
    points_[count_++] = highest;
  }
  void add_logarithmic(int per_decade) {
    const double step = std::pow(10.0, 1.0 / per_decade);
    for (double w = lowest_ * step; w < highest_; w *= step) add(w);
  }
  void add_even(int count) {
    for (int i = 1; i < count; ++i) add(lowest_ + (highest_ - lowest_) * i / count);
  }
  /// Points about a resonance at w whose half width is `width`.
  void add_resonance(double w, double width) {
    add(w);
    for (double reach = 0.25 * width; reach < 40 * width && reach < highest_; reach *= 1.4)
      add(w - reach), add(w + reach);
  }
  std::span<const double> sorted() {
    std::sort(points_.begin(), points_.begin() + static_cast<std::ptrdiff_t>(count_));
    count_ = static_cast<std::size_t>(
        std::unique(points_.begin(), points_.begin() + static_cast<std::ptrdiff_t>(count_)) - points_.begin());
    return {points_.data(), count_};
  }

 private:
  double lowest_, highest_;
  std::array<double, 12000> points_;
  std::size_t count_ = 0;
};

/// Margins of a sampled wall with a long delay.
void scan_sampled_loop(const LoopFunction& loop, const ClosedLoopPoles& poles, MarginCollector& collector) noexcept;

}  // namespace handloop::control
