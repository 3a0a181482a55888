#pragma once

#include <span>

#include "identify/spectra.h"

namespace handloop::identify {

/// The local polynomial method (Pintelon and Schoukens, System Identification, 2nd ed., section 7.2): over a few
/// neighbouring lines of the whole record's transform, the frequency response and the leakage of the record's ends are
/// both smooth, so each is a short polynomial in the line's number, and both are found by linear least squares. The
/// leakage that biases averaged segments near a resonance is removed instead of averaged.
struct LocalPolynomialSettings {
  std::size_t half_width = 15;  ///< lines to each side that share one fit
  int degree = 2;               ///< of both polynomials
  double lowest_Hz = 0.5;
  double highest_Hz = 30.0;
  std::size_t points = 0;  ///< frequencies wanted, evenly spread; 0: every line of the record
};

/// Frequencies are lines of the record's transform (the record is cut at its end by under 1 % where that makes its
/// length fast to transform). `coherence` is the share of the local output power that the fit explains; `variance` is
/// that of the response at the centre. Throws InputError like welch(), and where the record has fewer lines than one
/// fit asks for.
FrequencyResponse local_polynomial_response(std::span<const double> u, std::span<const double> y, double sample_time_s,
                                            const LocalPolynomialSettings& settings);

/// The same at given frequencies: each is answered at the nearest line of the record's transform.
FrequencyResponse local_polynomial_response(std::span<const double> u, std::span<const double> y, double sample_time_s,
                                            const LocalPolynomialSettings& settings,
                                            std::span<const double> frequencies_Hz);

}  // namespace handloop::identify
