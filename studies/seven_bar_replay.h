#pragma once

#include <array>
#include <vector>

#include "models/scenario.h"

/// Kazerooni and Her's f_h*: the hand force that moves the device through the same trajectory with no environment (6).
namespace handloop::studies {

struct NoEnvironment {
  std::array<std::vector<double>, 2>
      hand_N;                   ///< f_h* as the sensor says, at the times of the trajectory; N on the device
  double tracking_error = 0.0;  ///< rms distance from the trajectory over its rms, away from both ends
  double edge_s = 0.0;          ///< at either end the trajectory was left; do not compare there
};

/// Simulates the device without its load, its hand driven by a muscle force that is corrected until the handle follows
/// `position_m` (x, y by sample, `sample_time_s` apart, from rest at home). The model of the loop only speeds this up:
/// f_h* is what the force sensor of that simulation reads. Throws InputError where the scenario cannot be simulated.
NoEnvironment without_environment(const models::Scenario& scenario,
                                  const std::array<std::vector<double>, 2>& position_m, double sample_time_s);

/// Slope of f_e against f_h - f_h* through the origin, and the share of f_e's power it explains. The noise is in the
/// difference, so that is what is regressed on f_e.
struct Slope {
  double value = 0.0, explained = 0.0;
};
Slope force_slope(const std::vector<double>& difference_N, const std::vector<double>& environment_N);

}  // namespace handloop::studies
