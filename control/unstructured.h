#pragma once

#include <complex>

#include "control/loop.h"
#include "models/arm_uncertainty.h"

/// Robustness against unstructured variability of the arm: H(1 + W_u Delta) with any stable |Delta| <= 1.
namespace handloop::control {

/// What the arm faces at the grip, force over position in N/m: device and wall, D(s) = m s^2 + b s + G_z C(e^{sT}) with
/// the hold and delay G_z = e^{-sTd} (1 - e^{-sT})/(sT). The images that sampling adds are left out: control/arm_box.h
/// bounds them.
std::complex<double> faced_stiffness(const LoopPlant& plant, const LoopTiming& timing, const WallGains& gains,
                                     double frequency_rad_per_s);

/// Largest |W_u T| over a band, T = H D/(1 + H D) being what the uncertainty sees. Below 1 the loop stays stable for
/// every arm that the model admits, provided that the nominal loop is stable and the band holds all that matters.
struct UnstructuredPeak {
  double peak = 0.0;
  double frequency_Hz = 0.0;
};
/// Refined between the points of a logarithmic grid. The plant must have an arm.
UnstructuredPeak unstructured_peak(const LoopPlant& plant, const LoopTiming& timing, const WallGains& gains,
                                   const models::UncertaintyModel& uncertainty, double low_Hz, double high_Hz);

}  // namespace handloop::control
