#pragma once

#include <complex>
#include <functional>
#include <span>
#include <vector>

#include "identify/spectra.h"

namespace handloop::identify {

/// Transform of a whole record behind a cosine taper, its mean removed, and its division into bands.
class TaperedRecord {
 public:
  /// `taper`: share of the record under the cosine at each end. The record is cut by a few samples at its end to a
  /// length that is fast to transform. Throws InputError where a sample is not finite or a signal is constant.
  TaperedRecord(std::span<const double> u, std::span<const double> y, double sample_time_s, double lowest_Hz,
                double highest_Hz, double band_Hz, double taper);

  /// Model-free response of each band: u's gain as a quadratic in frequency, at the band's centre. Its residual is the
  /// noise.
  FrequencyResponse quadratic() const;

  /// Response of each band as the average of y/(model u) over its lines times the model at the centre: no bias by
  /// curvature once the model is near. Variances are those of the noise that quadratic() found.
  FrequencyResponse flattened(const std::function<std::complex<double>(double frequency_rad_per_s)>& model) const;

 private:
  struct Band {
    std::size_t first, last;  ///< lines, into U_ and Y_
    double centre_Hz;
    double noise;  ///< mean |noise|^2 of a line
    std::complex<double> response;
    double variance;
  };
  void fit_quadratic(Band& band) const;

  double line_Hz_ = 0.0;
  double correlation_ = 1.0;  ///< by how much the taper raises the variance of an average over lines
  std::vector<std::complex<double>> U_, Y_;
  std::vector<Band> bands_;
};

}  // namespace handloop::identify
