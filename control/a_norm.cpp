#include "control/a_norm.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "control/transfer_loop.h"
#include "models/errors.h"
#include "models/polynomial.h"

namespace handloop::control {
namespace {

using Real = long double;
using Complex = std::complex<Real>;

/// g(t) = sum r exp(p t).
struct Modes {
  std::vector<Complex> pole, residue;

  Real value(Real t) const {
    Real g = 0;
    for (std::size_t i = 0; i < pole.size(); ++i) g += (residue[i] * std::exp(pole[i] * t)).real();
    return g;
  }
  /// An antiderivative that vanishes at infinity.
  Real integral(Real t) const {
    Real g = 0;
    for (std::size_t i = 0; i < pole.size(); ++i) g += (residue[i] / pole[i] * std::exp(pole[i] * t)).real();
    return g;
  }
  /// Area of the tail where nothing cancels.
  Real tail(Real t) const {
    Real area = 0;
    for (std::size_t i = 0; i < pole.size(); ++i) {
      area += std::abs(residue[i]) * std::exp(pole[i].real() * t) / -pole[i].real();
    }
    return area;
  }
};

/// Multiple poles would need powers of t: they are drawn apart by so little (on a circle about their place, so that the
/// error is of that distance to the power of how many there are) that nothing is lost.
void separate(std::vector<Complex>& poles) {
  constexpr Real kApart = 1e-5L;
  std::vector<bool> done(poles.size(), false);
  for (std::size_t i = 0; i < poles.size(); ++i) {
    if (done[i]) continue;
    std::vector<std::size_t> cluster;
    for (std::size_t k = i; k < poles.size(); ++k) {
      if (!done[k] && std::abs(poles[k] - poles[i]) < kApart * std::abs(poles[i])) cluster.push_back(k);
    }
    Complex centre = 0;
    for (const auto k : cluster) centre += poles[k] / static_cast<Real>(cluster.size());
    const Real radius = (cluster.size() > 2 ? 10 : 1) * kApart * std::abs(centre);
    for (std::size_t n = 0; n < cluster.size(); ++n) {
      done[cluster[n]] = true;
      if (cluster.size() == 1) continue;
      const Real angle = 2 * std::numbers::pi_v<Real> * static_cast<Real>(n) / static_cast<Real>(cluster.size());
      poles[cluster[n]] = centre + radius * Complex(std::cos(angle), std::sin(angle));
    }
  }
}

Modes modes_of(const std::vector<double>& numerator, const std::vector<double>& denominator) {
  Modes modes;
  for (const auto& root : polynomial_roots(denominator)) modes.pole.emplace_back(root.real(), root.imag());
  separate(modes.pole);
  for (std::size_t i = 0; i < modes.pole.size(); ++i) {
    Complex slope = static_cast<Real>(denominator[0]);
    for (std::size_t k = 0; k < modes.pole.size(); ++k) {
      if (k != i) slope *= modes.pole[i] - modes.pole[k];
    }
    modes.residue.push_back(models::evaluate_polynomial(numerator, modes.pole[i]) / slope);
  }
  return modes;
}

Real crossing(const Modes& modes, Real from, Real to) {
  const bool rising = modes.value(to) > 0;
  for (int i = 0; i < 80; ++i) {
    const Real middle = (from + to) / 2;
    ((modes.value(middle) > 0) == rising ? to : from) = middle;
  }
  return (from + to) / 2;
}

/// The next point of the grid: a share of the period or life of every mode that still matters.
Real step_at(const Modes& modes, Real t, Real floor) {
  constexpr Real kShare = 0.01L;
  Real fastest = 0;
  for (std::size_t i = 0; i < modes.pole.size(); ++i) {
    const Real left = std::abs(modes.residue[i]) * std::exp(modes.pole[i].real() * t) / std::abs(modes.pole[i]);
    if (left > floor) fastest = std::max(fastest, std::abs(modes.pole[i]));
  }
  return fastest > 0 ? kShare / fastest : 0;
}

/// Where nothing but one pair of conjugate poles is left, the rest of the area from a zero at t on is a geometric
/// series of half waves. Returns a negative number where more is left.
Real rest_of_one_wave(const Modes& modes, Real t, Real floor) {
  const Complex* wave = nullptr;
  for (std::size_t i = 0; i < modes.pole.size(); ++i) {
    const auto& pole = modes.pole[i];
    const Real left = std::abs(modes.residue[i]) * std::exp(pole.real() * t) / -pole.real();
    if (left < floor) continue;
    if (pole.imag() == 0 || (wave != nullptr && wave->imag() * pole.imag() > 0)) return -1;
    wave = &pole;
  }
  if (wave == nullptr) return -1;
  const Real half_period = std::numbers::pi_v<Real> / std::abs(wave->imag());
  const Real first = std::abs(modes.integral(t + half_period) - modes.integral(t));
  return first / -std::expm1(wave->real() * half_period);
}

}  // namespace

ANorm a_norm(const TransferFunction& function) {
  const auto numerator = trimmed(function.numerator), denominator = trimmed(function.denominator);
  if (numerator == std::vector{0.0}) return {};
  if (numerator.size() >= denominator.size()) {
    throw InputError("an impulse response has a finite area only where there are more poles than zeros");
  }
  const Modes modes = modes_of(numerator, denominator);
  for (const auto& pole : modes.pole) {
    if (!(pole.real() < 0)) return {std::numeric_limits<double>::infinity(), 0.0};
  }
  // Modes are left out once they could not change the area by a ten-millionth of its least possible value, |G(0)|, or
  // of the largest single mode where that is small.
  Real scale = std::abs(modes.integral(0));
  for (std::size_t i = 0; i < modes.pole.size(); ++i) {
    scale = std::max(scale, std::abs(modes.residue[i] / modes.pole[i].real()) * 1e-6L);
  }
  const Real floor = 1e-10L * scale;
  Real area = 0, from = 0, begin = modes.integral(0), t = 0, before = modes.value(1e-30L);
  while (modes.tail(t) > floor) {
    const Real step = step_at(modes, t, floor * 1e-3L);
    if (step == 0) break;
    const Real next = t + step;
    const Real here = modes.value(next);
    if (before * here < 0) {
      const Real at = crossing(modes, t, next);
      const Real end = modes.integral(at);
      area += std::abs(end - begin);
      begin = end;
      from = at;
      if (const Real rest = rest_of_one_wave(modes, at, floor); rest >= 0) {
        return {static_cast<double>(area + rest), static_cast<double>(2 * floor)};
      }
    }
    if (here != 0) before = here;
    t = next;
  }
  area += std::abs(begin - modes.integral(std::max(t, from)));
  return {static_cast<double>(area), static_cast<double>(2 * modes.tail(t) + floor)};
}

}  // namespace handloop::control
