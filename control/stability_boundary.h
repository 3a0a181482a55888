#pragma once

#include <array>
#include <limits>
#include <vector>

#include "control/closed_loop_verdict.h"
#include "control/loop.h"
#include "control/sampled_plant.h"

/// Where in the plane of wall stiffness K and wall damping B the loop is stable, without filling a grid. On the
/// boundary a closed-loop pole lies on the unit circle; at a given z = e^{j theta} the characteristic equation is
/// linear in K and B, so that the boundary is a curve known in closed form (D-partition, Neimark 1948; Gryazina, Polyak
/// and Tremba 2008).
namespace handloop::control {

/// The open intervals of K in which the loop is stable at one damping B, rising.
struct StableStiffness {
  struct Interval {
    double low = 0.0, high = 0.0;
    double low_at_rad_per_s = 0.0, high_at_rad_per_s = 0.0;  ///< where a pole meets the circle
  };
  std::array<Interval, 8> intervals{};
  int count = 0;
};

/// Exact, from K = lowest to highest (which bound the first and last interval where no pole crosses there). Delays up
/// to kMaxPolynomialDelay by polynomial roots, longer ones (to ClosedLoopVerdict::kMaxDelay) by search. Throws
/// InputError for longer delays still.
StableStiffness stable_stiffness(const SampledPlant& plant, const LoopTiming& timing, double damping_Ns_per_m,
                                 double lowest_N_per_m = 0.0,
                                 double highest_N_per_m = std::numeric_limits<double>::infinity());

/// K_cr: the largest stiffness up to which, from nearly none, the loop is stable; 0 where a soft wall is unstable
/// already, infinity where no stiffness destabilises.
double critical_stiffness(const SampledPlant& plant, const LoopTiming& timing, double damping_Ns_per_m);

/// The part of the K-B plane that is drawn.
struct GainWindow {
  double stiffness_low = 0.0, stiffness_high = 5000.0;  ///< N/m
  double damping_low = 0.0, damping_high = 10.0;        ///< N s/m
};

/// A piece of the boundary: stable on one side, unstable on the other.
struct BoundaryPiece {
  struct Point {
    double stiffness_N_per_m, damping_Ns_per_m;
    double frequency_rad_per_s;  ///< at which the loop rings there
  };
  std::vector<Point> points;
};

/// The whole boundary inside the window, as curves with no gap wider than about a 500th of it.
std::vector<BoundaryPiece> trace_boundary(const SampledPlant& plant, const LoopTiming& timing,
                                          const GainWindow& window);

}  // namespace handloop::control
