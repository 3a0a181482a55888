#pragma once

#include <cmath>
#include <complex>
#include <numbers>

#include "control/margins.h"

namespace handloop::control {

/// Gathers the margins of a stable loop from the places where they can occur: crossings of |L| = 1, of the negative
/// real axis, and candidates for the point nearest to -1. Keeps the smallest of each.
class MarginCollector {
 public:
  explicit MarginCollector(Margins& margins) : m_(margins) {
    m_.gain_up = m_.phase_deg = m_.delay_s = m_.modulus = Margins::kInfinity;
    m_.gain_down = 0;
    peak_ = 0;
  }

  /// A frequency where |L| = 1.
  void gain_crossing(std::complex<double> loop, double frequency_rad_per_s) {
    constexpr double kDegrees = 180 / std::numbers::pi;
    const double phase = std::arg(-loop);  // of L above -180 degrees, in (-pi, pi]
    if (std::abs(phase) * kDegrees < std::abs(m_.phase_deg)) {
      m_.phase_deg = phase * kDegrees;
      m_.phase_at_rad_per_s = frequency_rad_per_s;
    }
    const double lag = phase < 0 ? phase + 2 * std::numbers::pi : phase;
    if (frequency_rad_per_s > 0 && lag / frequency_rad_per_s < m_.delay_s) {
      m_.delay_s = lag / frequency_rad_per_s;
      m_.delay_at_rad_per_s = frequency_rad_per_s;
    }
  }

  /// A frequency where L is real: a margin where it is negative.
  void phase_crossing(double loop, double frequency_rad_per_s) {
    if (!(loop < 0) || std::isinf(loop)) return;
    const double factor = -1 / loop;
    if (factor > 1 && factor < m_.gain_up) {
      m_.gain_up = factor, m_.gain_up_at_rad_per_s = frequency_rad_per_s;
    } else if (factor < 1 && factor > m_.gain_down) {
      m_.gain_down = factor, m_.gain_down_at_rad_per_s = frequency_rad_per_s;
    }
  }

  /// Any frequency; L = numerator/denominator, either of which may be zero.
  void distance(std::complex<double> numerator, std::complex<double> denominator, double frequency_rad_per_s) {
    const double sum = std::abs(numerator + denominator);
    const double modulus = sum / std::abs(denominator), peak = std::abs(denominator - numerator) / sum;
    if (modulus < m_.modulus) m_.modulus = modulus, m_.modulus_at_rad_per_s = frequency_rad_per_s;
    if (peak > peak_) peak_ = peak, m_.disk_at_rad_per_s = frequency_rad_per_s;
  }

  double modulus() const { return m_.modulus; }
  double peak() const { return peak_; }

  /// No margin was found to vanish: states the disk margin.
  void finish() { m_.disk_alpha = 2 / peak_; }

 private:
  Margins& m_;
  double peak_;  ///< max |S - T|
};

}  // namespace handloop::control
