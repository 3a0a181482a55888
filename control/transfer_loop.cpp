#include "control/transfer_loop.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "control/margin_collector.h"
#include "control/scan.h"
#include "models/errors.h"
#include "models/polynomial.h"

namespace handloop::control {

using models::evaluate_polynomial;
namespace {

using Complex = std::complex<double>;
using Long = std::complex<long double>;
constexpr double kPi = std::numbers::pi;

std::vector<double> without_leading_zeros(std::vector<double> c) {
  const auto first = std::find_if(c.begin(), c.end(), [](double x) { return x != 0; });
  c.erase(c.begin(), first == c.end() ? c.end() : first);
  return c;
}

/// Radii at which the roots lie, by the upper hull of log |coefficients| (Bini 1996). c: highest first, c.back() != 0.
std::vector<long double> root_radii(const std::vector<double>& c) {
  const std::size_t n = c.size() - 1;
  std::vector<std::size_t> hull;
  const auto height = [&](std::size_t i) { return std::log(std::abs(static_cast<long double>(c[i]))); };
  for (std::size_t i = 0; i <= n; ++i) {
    if (c[i] == 0) continue;
    while (hull.size() >= 2) {
      const auto a = hull[hull.size() - 2], b = hull.back();
      const auto before = (height(b) - height(a)) / static_cast<long double>(b - a);
      const auto after = (height(i) - height(b)) / static_cast<long double>(i - b);
      if (after < before) break;
      hull.pop_back();
    }
    hull.push_back(i);
  }
  std::vector<long double> radii;
  for (std::size_t k = 1; k < hull.size(); ++k) {
    const auto a = hull[k - 1], b = hull[k];
    const auto radius = std::exp((height(b) - height(a)) / static_cast<long double>(b - a));
    radii.insert(radii.end(), b - a, radius);
  }
  return radii;
}

/// How much of a pole's distance to the axis is rounding.
constexpr double kOnAxis = 1e-13;

/// Sum of two polynomials aligned at the constant term.
std::vector<double> sum(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> s(std::max(a.size(), b.size()), 0.0);
  for (std::size_t i = 0; i < a.size(); ++i) s[s.size() - a.size() + i] += a[i];
  for (std::size_t i = 0; i < b.size(); ++i) s[s.size() - b.size() + i] += b[i];
  return s;
}

/// The highest and lowest of the frequencies at which anything happens.
std::pair<double, double> feature_range(const std::vector<std::vector<Complex>>& sets) {
  double low = Margins::kInfinity, high = 0;
  for (const auto& set : sets) {
    for (const Complex p : set) {
      if (std::abs(p) == 0) continue;
      low = std::min(low, std::abs(p));
      high = std::max(high, std::abs(p));
    }
  }
  return high > 0 ? std::pair(low, high) : std::pair(1.0, 1.0);
}

}  // namespace

std::vector<Complex> polynomial_roots(const std::vector<double>& coefficients) {
  std::vector<double> c = without_leading_zeros(coefficients);
  std::vector<Complex> roots;
  while (!c.empty() && c.back() == 0) c.pop_back(), roots.emplace_back(0.0);  // roots at zero are exact
  if (c.size() < 2) return roots;
  const auto radii = root_radii(c);
  std::vector<Long> z;
  for (std::size_t i = 0; i < radii.size(); ++i) {
    z.push_back(std::polar(radii[i], 0.4L + 2.399963229728653L * static_cast<long double>(i)));
  }
  for (int sweep = 0; sweep < 300; ++sweep) {
    long double moved = 0;
    for (std::size_t i = 0; i < z.size(); ++i) {
      Long value = 0, slope = 0;
      for (const double a : c) slope = slope * z[i] + value, value = value * z[i] + static_cast<long double>(a);
      if (value == 0.0L) continue;
      Long repulsion = 0;
      for (std::size_t j = 0; j < z.size(); ++j) {
        if (j != i && z[j] != z[i]) repulsion += 1.0L / (z[i] - z[j]);
      }
      const Long newton = value / slope, step = newton / (1.0L - newton * repulsion);
      if (!std::isfinite(std::abs(step))) {
        z[i] *= Long(1.01L, 0.013L);
        moved = 1;
        continue;
      }
      z[i] -= step;
      moved = std::max(moved, std::abs(step) / std::max(std::abs(z[i]), std::numeric_limits<long double>::min()));
    }
    if (moved < 1e-18L) break;
  }
  for (const Long& root : z) {
    // real coefficients: what is real but for rounding is real
    const double imaginary = std::abs(root.imag()) < 1e-15L * std::abs(root) ? 0.0 : static_cast<double>(root.imag());
    roots.emplace_back(static_cast<double>(root.real()), imaginary);
  }
  return roots;
}

Complex TransferLoop::operator()(double w) const {
  const Complex x = sample_time_s ? std::polar(1.0, w * *sample_time_s) : Complex(0, w);
  return evaluate_polynomial(numerator, x) / evaluate_polynomial(denominator, x) * std::polar(1.0, -w * delay_s);
}

void require_valid(const TransferLoop& loop) {
  const auto check = [](const std::vector<double>& c, const char* name) {
    if (c.empty())
      throw InputError(std::string(name) + ": no coefficients; give them highest power first, as in 1,2,3");
    for (const double a : c) {
      if (!std::isfinite(a)) throw InputError(std::string(name) + ": coefficients must be finite numbers");
    }
  };
  check(loop.numerator, "numerator");
  check(loop.denominator, "denominator");
  const auto num = without_leading_zeros(loop.numerator), den = without_leading_zeros(loop.denominator);
  if (den.empty()) throw InputError("denominator: all coefficients are zero; at least one must differ");
  if (loop.sample_time_s && !(*loop.sample_time_s > 0 && std::isfinite(*loop.sample_time_s))) {
    throw InputError("sample time must be a finite number of seconds above zero");
  }
  if (!(loop.delay_s >= 0 && std::isfinite(loop.delay_s)))
    throw InputError("delay must be a finite number of seconds, zero or more");
  if (loop.sample_time_s && loop.delay_s > 0) {
    throw InputError("delay: a discrete loop takes its delay as powers of z in the denominator (append zeros)");
  }
  if (loop.sample_time_s && num.size() > den.size()) {
    throw InputError("a discrete loop with numerator degree " + std::to_string(num.size() - 1) +
                     " over denominator degree " + std::to_string(den.size() - 1) +
                     " needs samples of the future: the denominator's degree must be at least the numerator's");
  }
}

TransferMargins evaluate(const TransferLoop& loop) {
  require_valid(loop);
  const auto num = without_leading_zeros(loop.numerator), den = without_leading_zeros(loop.denominator);
  const bool discrete = loop.sample_time_s.has_value();
  TransferMargins result;
  Margins& m = result.margins;
  const auto closed = sum(num, den);
  result.poles = polynomial_roots(closed);
  // 1 + L vanishes at infinity where the leading powers cancel
  const bool well_posed = without_leading_zeros(closed).size() == std::max(num.size(), den.size());
  m.rho = 0;
  double abscissa = -Margins::kInfinity;
  bool stable = well_posed;
  for (const Complex p : result.poles) {
    m.rho = std::max(m.rho, std::abs(p));
    abscissa = std::max(abscissa, p.real());
    if (discrete ? std::abs(p) >= 1 - kOnAxis : p.real() >= -kOnAxis * std::abs(p)) stable = false;
  }
  if (!well_posed) m.rho = Margins::kInfinity;
  if (!discrete && !result.poles.empty()) result.abscissa = abscissa;

  const auto zeros = polynomial_roots(num), poles = polynomial_roots(den);
  const double T = discrete ? *loop.sample_time_s : 0.0;
  double low = 1e-6, high = 1;
  if (discrete) {
    low = 1e-6 * kPi / T, high = kPi / T;
  } else {
    const auto range = feature_range({zeros, poles, result.poles});
    low = 1e-4 * range.first, high = 1e4 * range.second;
  }
  FrequencyGrid grid(low, high);
  const double decades = std::log10(high / low);
  grid.add_logarithmic(static_cast<int>(std::clamp(3000 / decades, 20.0, 200.0)));
  if (discrete) grid.add_even(2000);
  for (const auto* set : {&zeros, &poles, static_cast<const std::vector<Complex>*>(&result.poles)}) {
    for (const Complex p : *set) {
      if (discrete) {
        if (p.imag() >= 0 && std::abs(p) > 0.3)
          grid.add_resonance(std::arg(p) / T, std::max(std::abs(1 - std::abs(p)), 1e-12) / T);
      } else if (p.imag() > 0) {
        grid.add_resonance(p.imag(), std::max(std::abs(p.real()), 1e-12 * std::abs(p)));
      }
    }
  }
  if (loop.delay_s > 0) {
    for (double w = 0.1 / loop.delay_s; w < high && w < 500 / loop.delay_s; w += 0.1 / loop.delay_s) grid.add(w);
  }
  const auto points = grid.sorted();
  const auto response = [&](double w) {
    const Complex x = discrete ? std::polar(1.0, w * T) : Complex(0, w);
    const Complex delay = loop.delay_s > 0 ? std::polar(1.0, -w * loop.delay_s) : Complex(1);
    return ResponsePoint{evaluate_polynomial(num, x) * delay, evaluate_polynomial(den, x)};
  };
  const double at_infinity = num.size() < den.size()   ? 0.0
                             : num.size() > den.size() ? Margins::kInfinity
                                                       : std::abs(num.front() / den.front());

  if (loop.delay_s > 0) {
    // roots cross the axis as the delay grows from zero, at each gain crossing once a turn of its phase
    if (at_infinity >= 1) stable = false;
    long crossed = 0;
    const auto without_delay = [&](double w) {
      return evaluate_polynomial(num, Complex(0, w)) / evaluate_polynomial(den, Complex(0, w));
    };
    detail::roots_on_grid(
        points, [&](double w) { return std::clamp(2 * std::log(std::abs(without_delay(w))), -1e3, 1e3); },
        [&](double w) {
          const double phase = std::arg(-without_delay(w)), lag = phase <= 0 ? phase + 2 * kPi : phase;
          const double turns = (loop.delay_s * w - lag) / (2 * kPi);
          if (turns < 0) return;
          const bool falling = std::abs(without_delay(w * (1 + 1e-7))) < std::abs(without_delay(w * (1 - 1e-7)));
          crossed += (falling ? 1 : -1) * (static_cast<long>(std::floor(turns)) + 1);
        });
    if (crossed != 0) stable = false;
  }
  m.stable = stable;
  if (!stable) return result;

  MarginCollector collector(m);
  if (num.empty()) {
    collector.distance(0.0, 1.0, 0.0);
    collector.finish();
    return result;
  }
  scan_response(points, response, collector);
  // the ends: zero frequency, and Nyquist or infinity
  const auto end = [&](double n, double d, double w) {
    if (d != 0) collector.phase_crossing(n / d, w);
    collector.distance(n, d, w);
  };
  if (discrete) {
    end(evaluate_polynomial(num, Complex(1.0)).real(), evaluate_polynomial(den, Complex(1.0)).real(), 0.0);
    end(evaluate_polynomial(num, Complex(-1.0)).real(), evaluate_polynomial(den, Complex(-1.0)).real(), kPi / T);
  } else {
    end(num.back(), den.back(), 0.0);
    if (num.size() == den.size() && loop.delay_s == 0) end(num.front(), den.front(), Margins::kInfinity);
    if (num.size() < den.size()) collector.distance(0.0, 1.0, Margins::kInfinity);
    if (at_infinity >= 1) m.delay_s = 0, m.delay_at_rad_per_s = Margins::kInfinity;
  }
  collector.finish();
  return result;
}

}  // namespace handloop::control
