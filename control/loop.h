#pragma once

#include <cmath>
#include <numbers>
#include <optional>

#include "models/arm.h"

/// The sampled-data loop a designer tunes, in the terms of the device: a tip that a hand holds, read and driven once a
/// sample by a virtual wall. One axis, SI units, position positive along the axis, negative feedback.
///
///     wall C(z) -> hold (zero order) -> plant P(s) -> sampler -> delay z^-d -> wall
///
///     P(s) = 1/(m s^2 + b s + 1/H(s))                       tip mass and damping in parallel with the arm's compliance
///     H C(z) = K + B (1-a)/T (z-1)/(z-a),  a = exp(-2 pi f_c T)   spring and filtered damper L(z) = C(z) z^-d
///     ZOH{P}(z)
namespace handloop::control {

/// What the wall pushes against on one axis. Without an arm the tip is free: P = 1/(m s^2 + b s).
struct LoopPlant {
  double tip_mass_kg = 0.075;          ///< device, stylus and gimbal as felt at the tip; above zero
  double tip_damping_Ns_per_m = 0.05;  ///< of the device; zero or more
  std::optional<models::ArmParameters> arm;

  bool operator==(const LoopPlant&) const = default;
};

/// When the loop runs and what it filters.
struct LoopTiming {
  double sample_time_s = 0.001;
  int delay_samples = 1;     ///< whole samples between reading and acting, 0 to kMaxDelaySamples
  double cutoff_Hz = 100.0;  ///< of the damper's derivative filter; infinity: plain backward difference

  /// Pole of the derivative filter, a = exp(-2 pi f_c T).
  double filter_pole() const { return std::exp(-2 * std::numbers::pi * cutoff_Hz * sample_time_s); }
  bool operator==(const LoopTiming&) const = default;
};

inline constexpr int kMaxDelaySamples = 64;

/// Stiffness and damping of the virtual wall.
struct WallGains {
  double stiffness_N_per_m = 0.0;
  double damping_Ns_per_m = 0.0;

  bool operator==(const WallGains&) const = default;
};

/// One loop, complete.
struct Loop {
  LoopPlant plant;
  LoopTiming timing;
  WallGains gains;

  bool operator==(const Loop&) const = default;
};

/// Throws InputError naming the quantity that is not possible (not finite, tip mass not above zero, negative damping,
/// sample time not above zero, delay out of range, gains not finite). Gains may be negative.
void require_valid(const LoopPlant& plant);
void require_valid(const LoopTiming& timing);
void require_valid(const Loop& loop);

}  // namespace handloop::control
