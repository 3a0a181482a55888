#pragma once

#include <array>
#include <complex>
#include <vector>

#include "models/scenario.h"

/// Measurements on the simulated seven-bar linkage, through its converters, sensors and controller: what its position
/// controller really does, and from which alpha on it really is unstable.
namespace handloop::studies {

/// One frequency and axis (0: x, 1: y): p = G p_des + S_h f_h + S_e f_ext.
struct PrimaryPoint {
  std::size_t axis = 0;
  double frequency_rad_per_s = 0.0;
  std::complex<double> G;            ///< p/p_des
  std::complex<double> S_h_m_per_N;  ///< of forces of the hand at the handle
  std::complex<double> S_e_m_per_N;  ///< of forces on the load beside its own inertia and weight, as they count at the
                                     ///< handle
};
struct PrimaryRequest {
  std::vector<double> frequencies_rad_per_s;  ///< moved to the nearest lines of the period, x and y on different ones
  double period_s = 8.0;                      ///< of the excitation: the longest wave it can hold
  double settle_s = 10.0;                     ///< before it is measured; G settles with 0.63 1/s
  bool sensitivities = true;  ///< S_h and S_e too, else they are 0 (and S_h f_h stays in G: below 0.1 %)
};
/// At the scenario's pose, K cut off. Throws InputError where the scenario cannot be simulated.
std::vector<PrimaryPoint> measure_primary(const models::Scenario& scenario, const PrimaryRequest& request);

/// The loop's fate after a small push along one axis: growth rate of the hand force's oscillation, 1/s.
double simulated_growth_per_s(const models::Scenario& scenario, std::size_t axis);
/// alpha along one axis (the other at 1) at which oscillations neither grow nor die, found between two
/// simulated growth rates around `near`.
double simulated_alpha_limit(const models::Scenario& scenario, std::size_t axis, double near);

}  // namespace handloop::studies
