#include "control/passivity.h"

#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <limits>
#include <numbers>

#include "control/loop_function.h"

namespace handloop::control {
namespace {

constexpr double kPi = std::numbers::pi;
using Complex = std::complex<double>;

/// (1 - e^{-j theta}) H/(1 - cos theta) = (1 + j cot(theta/2)) H; its real part, for K = 1 and for B = 1 apart.
struct Energy {
  double stiffness, damping;
};

Energy energy_at(const LoopTiming& timing, double theta) {
  const double T = timing.sample_time_s;
  const int d = timing.delay_samples;
  if (theta < 1e-7) return {1.0 + 2 * d, -2 / T};  // the limit
  const double one_minus_a = -std::expm1(-2 * kPi * timing.cutoff_Hz * T);
  const Complex delta = LoopFunction::delta_at(theta).std();
  const Complex late = std::polar(1.0, -d * theta), weight(1.0, 1 / std::tan(theta / 2));
  return {(weight * late).real(), (weight * late * (one_minus_a / T * delta / (delta + one_minus_a))).real()};
}

/// Largest value of f over [0, pi], sharpened.
template <class F>
std::pair<double, double> largest(F&& f, int points) {
  double best = f(0.0), where = 0;
  const auto offer = [&](double x, double v) {
    if (v > best) best = v, where = x;
  };
  offer(kPi, f(kPi));
  for (int i = 1; i < points; ++i) {
    const double x = kPi * i / points, v = f(x);
    if (v >= f(kPi * (i - 1) / points) && v >= f(kPi * (i + 1) / points)) {
      const auto [at, value] = boost::math::tools::brent_find_minima(
          [&](double t) { return -f(t); }, kPi * (i - 1) / points, kPi * (i + 1) / points, 40);
      offer(at, -value);
    }
  }
  return {best, where};
}

int points_for(const LoopTiming& timing) {
  return 400 + 100 * timing.delay_samples;
}

}  // namespace

double colgate_required_damping(const LoopTiming& timing, const WallGains& gains) {
  const auto needed = [&](double theta) {
    const Energy e = energy_at(timing, theta);
    return gains.stiffness_N_per_m * e.stiffness + gains.damping_Ns_per_m * e.damping;
  };
  return 0.5 * timing.sample_time_s * largest(needed, points_for(timing)).first;
}

double colgate_permitted_stiffness(const LoopTiming& timing, double damping, double device_damping) {
  if (colgate_required_damping(timing, {0.0, damping}) > device_damping)
    return std::numeric_limits<double>::quiet_NaN();
  double low = 0, high = 1;
  while (colgate_required_damping(timing, {high, damping}) <= device_damping) {
    low = high, high *= 2;
    if (high > 1e12) return std::numeric_limits<double>::infinity();
  }
  for (int i = 0; i < 60; ++i) {
    const double K = 0.5 * (low + high);
    (colgate_required_damping(timing, {K, damping}) <= device_damping ? low : high) = K;
  }
  return low;
}

double gil_stiffness(const LoopTiming& timing, double damping, double physical_damping) {
  return (physical_damping + damping) / (timing.sample_time_s * (0.5 + timing.delay_samples));
}

AbbottOkamura abbott_okamura(const LoopTiming& timing, double device_damping, double coulomb, double resolution) {
  const double T = timing.sample_time_s;
  return {2 * device_damping / ((1 + 2 * timing.delay_samples) * T),
          resolution > 0 ? 2 * coulomb / resolution : std::numeric_limits<double>::infinity()};
}

Diolaiti diolaiti(const LoopTiming& timing, double stiffness, double device_damping, double coulomb,
                  double resolution) {
  Diolaiti d;
  d.damping_ratio = device_damping / (stiffness * timing.sample_time_s);
  d.friction_ratio = resolution > 0 ? coulomb / (stiffness * resolution) : std::numeric_limits<double>::infinity();
  d.damping_suffices = d.damping_ratio >= 0.5 + timing.delay_samples;
  d.friction_suffices = d.friction_ratio >= 0.5;
  return d;
}

Llewellyn llewellyn(const LoopTiming& timing, const WallGains& gains, double device_damping) {
  const double T = timing.sample_time_s;
  const double one_minus_a = -std::expm1(-2 * kPi * timing.cutoff_Hz * T);
  const auto minus_eta = [&](double theta) {
    theta = std::clamp(theta, 1e-4, kPi - 1e-6);
    const Complex delta = LoopFunction::delta_at(theta).std();
    const Complex wall =
        gains.stiffness_N_per_m + gains.damping_Ns_per_m * one_minus_a / T * delta / (delta + one_minus_a);
    const Complex admittance = Complex(0, 2 / T * std::tan(theta / 2)) / wall;  // velocity over force, trapezoidal
    const double half = theta / 2, lag = theta * (timing.delay_samples + 0.5), transmitted = std::sin(half) / half;
    // h12 h21 = -hold: its real part is -|hold| cos(lag); written so that eta - 1 keeps its digits at low frequency
    const double eta_minus_1 =
        2 * device_damping * admittance.real() / transmitted - 2 * std::sin(lag / 2) * std::sin(lag / 2);
    return -eta_minus_1 / (theta * theta);  // weighed so that low frequencies, where both vanish, are judged too
  };
  const auto [worst, theta] = largest(minus_eta, points_for(timing));
  const double at = std::max(theta, 1e-4);
  return {1 - worst * at * at, at / T};
}

double llewellyn_permitted_stiffness(const LoopTiming& timing, double damping, double device_damping) {
  const auto good = [&](double K) { return llewellyn(timing, {K, damping}, device_damping).absolutely_stable(); };
  double low = 1e-6, high = 1;
  if (!good(low)) return 0;
  while (good(high)) {
    low = high, high *= 2;
    if (high > 1e12) return std::numeric_limits<double>::infinity();
  }
  for (int i = 0; i < 50; ++i) {
    const double K = 0.5 * (low + high);
    (good(K) ? low : high) = K;
  }
  return low;
}

}  // namespace handloop::control
