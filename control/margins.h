#pragma once

#include <array>
#include <complex>
#include <limits>

#include "control/loop.h"
#include "control/sampled_plant.h"

namespace handloop::control {

/// How far a loop is from instability. Margins mean something only where `stable` is true; elsewhere they are NaN.
/// Frequencies are in rad/s, NaN where there is no such margin.
struct Margins {
  static constexpr double kInfinity = std::numeric_limits<double>::infinity();
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

  bool stable = false;       ///< every closed-loop pole strictly inside the unit circle (continuous: left half-plane)
  double rho = kNone;        ///< largest modulus of a closed-loop pole
  double gain_up = kNone;    ///< smallest factor above 1 on the gain that destabilises; infinity where none does
  double gain_down = kNone;  ///< largest factor below 1 that destabilises; 0 where none does
  double phase_deg =
      kNone;               ///< smallest phase (by size, with its sign) that destabilises; infinity where |L| is never 1
  double delay_s = kNone;  ///< smallest added delay that destabilises; infinity where none does
  double modulus = kNone;  ///< min |1 + L|: distance of the Nyquist curve from -1
  double disk_alpha = kNone;  ///< disk margin 2 / max |S - T| of Seiler, Packard and Gahinet (2020), skew 0

  double gain_up_at_rad_per_s = kNone;
  double gain_down_at_rad_per_s = kNone;
  double phase_at_rad_per_s = kNone;
  double delay_at_rad_per_s = kNone;
  double modulus_at_rad_per_s = kNone;
  double disk_at_rad_per_s = kNone;
};

/// Gains and phases that a disk margin alpha (skew sigma) tolerates at once: factors from gain_low to gain_high, or
/// phase shifts to +-phase_deg (Seiler, Packard, Gahinet 2020; MATLAB's dm2gm and dm2pm). gain_high is infinity and
/// phase_deg 90 or more where the disk reaches that far.
struct DiskGuarantee {
  double gain_low = 0.0;
  double gain_high = 0.0;
  double phase_deg = 0.0;
};
DiskGuarantee disk_guarantee(double alpha, double skew = 0.0);

/// Poles and all margins of a loop, exact: crossings and peaks are roots of polynomials in y = |z - 1|^2, isolated
/// without a grid and sharpened on the factored loop. Throws InputError where the loop is not possible (require_valid);
/// otherwise allocates nothing. About 10 us.
Margins evaluate(const Loop& loop);

/// The same for a plant sampled before: for many gains on one plant. Does not check its arguments; real-time safe.
Margins evaluate(const SampledPlant& plant, const LoopTiming& timing, const WallGains& gains) noexcept;

/// Poles of the closed loop in z, in no particular order: 1 of the filter, 2 or 4 of the plant, and one a sample of
/// delay.
struct ClosedLoopPoles {
  std::array<std::complex<double>, 5 + kMaxDelaySamples> z{};
  int count = 0;
  double rho() const;  ///< largest modulus
};
ClosedLoopPoles closed_loop_poles(const SampledPlant& plant, const LoopTiming& timing, const WallGains& gains) noexcept;

/// Frequency responses of a loop at one frequency, 0 to pi/T: what Bode and Nyquist plots draw.
struct LoopResponse {
  std::complex<double> plant;                      ///< ZOH{P}, m/N
  std::complex<double> wall;                       ///< C, N/m
  std::complex<double> loop;                       ///< L, delay included
  std::complex<double> sensitivity;                ///< S = 1/(1 + L)
  std::complex<double> complementary_sensitivity;  ///< T = L/(1 + L)
};
LoopResponse loop_response(const SampledPlant& plant, const LoopTiming& timing, const WallGains& gains,
                           double frequency_rad_per_s) noexcept;

}  // namespace handloop::control
