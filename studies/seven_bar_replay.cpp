#include "studies/seven_bar_replay.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "control/force_control_primary.h"
#include "studies/seven_bar_simulation.h"

namespace handloop::studies {
namespace {

using Complex = std::complex<double>;
using Signals = std::array<std::vector<double>, 2>;

constexpr double kPad_s = 6.0;    ///< of nothing after the record, so that its end does not reach round to its start
constexpr double kTaper_s = 1.0;  ///< over which the trajectory ends
constexpr double kBand = 4.0;     ///< of the hand's own bandwidth, in which the force is sought
constexpr int kCorrections = 1;

/// Lines of a periodic force; index 0 is its mean.
struct Spectrum {
  double base_rad_per_s = 0.0;
  std::vector<Eigen::Vector2cd> lines;

  Eigen::Vector2d at(double t) const {
    Eigen::Vector2d sum = lines[0].real();
    const Complex turn = std::exp(Complex(0, base_rad_per_s * t));
    Complex now = 1.0;
    for (std::size_t k = 1; k < lines.size(); ++k) {
      now *= turn;
      sum += 2.0 * (lines[k] * now).real();
    }
    return sum;
  }
};

Eigen::Vector2cd line_of(const Signals& x, double w, double T, double period_s) {
  Eigen::Vector2cd sum = Eigen::Vector2cd::Zero();
  for (std::size_t n = 0; n < x[0].size(); ++n) {
    const Complex turn = std::exp(Complex(0, -w * static_cast<double>(n) * T));
    sum += Eigen::Vector2cd(x[0][n] * turn, x[1][n] * turn);
  }
  return sum * (T / period_s);
}

Signals tapered(const Signals& x, double T) {
  Signals y = x;
  const auto length = static_cast<std::size_t>(kTaper_s / T);
  for (auto& signal : y) {
    for (std::size_t k = 0; k < std::min(length, signal.size()); ++k) {
      const double s = std::sin(0.5 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(length));
      signal[signal.size() - 1 - k] *= s * s;
    }
  }
  return y;
}

double rms(const Signals& x, std::size_t from, std::size_t to) {
  double sum = 0.0;
  for (const auto& signal : x) {
    for (std::size_t k = from; k < to; ++k) sum += signal[k] * signal[k];
  }
  return std::sqrt(sum / static_cast<double>(std::max<std::size_t>(to - from, 1)));
}

}  // namespace

NoEnvironment without_environment(const models::Scenario& scenario, const Signals& position_m, double T) {
  models::Scenario bare = scenario;
  bare.force_amplifier.load_kg = 0.0;
  bare.force_amplifier.hand_leaves_s = 0.0;
  bare.force_amplifier.hand = models::SevenBarHand::printed;  // whose arm presses does not matter to (6)
  bare.force_amplifier.hand_cubic_N_per_m3 = 0.0;
  const Eigen::Vector2d th(bare.device.pose_rad[0], bare.device.pose_rad[1]);
  const control::ForceControl loop = control::force_control_of(bare, th);
  const control::ModelledPrimary primary(bare, th);

  const double length_s = static_cast<double>(position_m[0].size()) * T, period_s = length_s + kPad_s;
  Spectrum force;
  force.base_rad_per_s = 2 * std::numbers::pi / period_s;
  const double highest = kBand * 2 * std::numbers::pi * bare.force_amplifier.hand_bandwidth_Hz;
  force.lines.assign(static_cast<std::size_t>(highest / force.base_rad_per_s) + 1, Eigen::Vector2cd::Zero());
  const auto correct = [&](const Signals& error_m) {
    const Signals error = tapered(error_m, T);
    for (std::size_t k = 0; k < force.lines.size(); ++k) {
      const double w = std::max(static_cast<double>(k) * force.base_rad_per_s, 1e-6);
      const Complex jw(0, w);
      const Eigen::Matrix2cd compliance =
          loop.primary(jw) * loop.K(jw) * primary.sensing(w) * primary.tracking(w) * loop.alpha(jw) +
          primary.to_hand(w);
      const Eigen::Matrix2cd needed = compliance.inverse() + loop.hand(jw) * Eigen::Matrix2cd::Identity();
      force.lines[k] += needed * line_of(error, w, T, period_s);
    }
  };

  SevenBarSimulation what;
  what.scenario = bare;
  what.duration_s = length_s;
  what.guarded = false;
  what.every = static_cast<std::uint64_t>(std::lround(T / scenario.loop.sample_time_s));
  what.muscle = [&](double t) { return force.at(t); };
  NoEnvironment result;
  result.edge_s = 2.0 * kTaper_s;
  const auto edge = std::min(static_cast<std::size_t>(result.edge_s / T), position_m[0].size() / 3);
  correct(position_m);
  for (int round = 0;; ++round) {
    const auto trace = simulate(what);
    const std::size_t size = std::min(trace.size(), position_m[0].size());
    Signals error;
    for (std::size_t i = 0; i < 2; ++i) {
      error[i].resize(position_m[0].size(), 0.0);
      for (std::size_t k = 0; k < size; ++k) error[i][k] = position_m[i][k] - trace.position_m[i][k];
      result.hand_N[i] = trace.hand_N[i];
      result.hand_N[i].resize(position_m[0].size(), 0.0);
    }
    const std::size_t to = position_m[0].size() - edge;
    result.tracking_error = rms(error, edge, to) / std::max(rms(position_m, edge, to), 1e-12);
    if (round == kCorrections) return result;
    correct(error);
  }
}

Slope force_slope(const std::vector<double>& difference_N, const std::vector<double>& environment_N) {
  double product = 0.0, environment = 0.0, difference = 0.0;
  for (std::size_t k = 0; k < difference_N.size(); ++k) {
    product += difference_N[k] * environment_N[k];
    environment += environment_N[k] * environment_N[k];
    difference += difference_N[k] * difference_N[k];
  }
  if (product == 0.0) return {};
  return {environment / product, product * product / (environment * difference)};
}

}  // namespace handloop::studies
