#pragma once

#include <complex>
#include <string_view>
#include <vector>

#include "models/axis.h"

/// Unstructured variability of the arm: |W_u| of H = H_nominal (1 + W_u Delta), |Delta| <= 1, Table IV of the arm
/// paper.
namespace handloop::models {

enum class UncertaintySet {
  maximum,      ///< envelope of every subject and grip force
  percentile67  ///< envelope of the 67th percentile of the measured magnitudes
};

/// "max" or "67". Throws InputError for anything else.
UncertaintySet parse_uncertainty_set(std::string_view text);
std::string_view uncertainty_set_name(UncertaintySet set);

/// Eq. (5): V(s) = K prod(s - z_i)(s - z_i*) / prod(s - p_i)(s - p_i*). One member of every conjugate pair is given,
/// rad/s.
struct UncertaintyModel {
  double gain = 0.0;
  std::vector<std::complex<double>> zeros;
  std::vector<std::complex<double>> poles;

  /// V(s), dimensionless; s in rad/s.
  std::complex<double> operator()(std::complex<double> s) const;
};

/// Table IV as it is to be used. One entry differs from print: pole pair 5 of the 67 % model of Z reads
/// -8.002 +- 95.687j, not 5.687j (a lost digit: it then pairs with the zero -6.796 +- 95.29j and keeps the paper's own
/// bound of 0 dB, which the printed value breaks with +32.6 dB).
const UncertaintyModel& uncertainty(Axis axis, UncertaintySet set);
/// Table IV as printed.
const UncertaintyModel& uncertainty_as_printed(Axis axis, UncertaintySet set);
/// True for the one entry that was corrected.
bool is_corrected(Axis axis, UncertaintySet set);

struct UncertaintyPeak {
  double frequency_Hz = 0.0;
  double magnitude_dB = 0.0;
};

/// Largest |V| between two frequencies, refined beyond its grid.
UncertaintyPeak peak(const UncertaintyModel& model, double low_Hz = 0.6, double high_Hz = 30.0);

}  // namespace handloop::models
