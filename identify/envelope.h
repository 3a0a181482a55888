#pragma once

#include <span>

#include "models/arm_uncertainty.h"

namespace handloop::identify {

struct EnvelopeSettings {
  int most_pairs = 5;           ///< of poles, and of zeros: order 10
  double least_damping = 0.05;  ///< of any pair: nothing narrower than the data can show
  /// The data are joined by straight lines (dB over Hz) and held off there too: at so many places a bin, and at more
  /// where bins are far apart, so that no pair fits between two places unseen.
  int points_between = 2;
};

/// A stable, minimum-phase V(s) of eq. (5) beside the magnitudes it envelopes.
struct Envelope {
  models::UncertaintyModel model;
  double mean_excess_dB = 0.0;  ///< mean over the given frequencies of |V| above the data
  double largest_excess_dB = 0.0;
  double least_excess_dB = 0.0;  ///< below 0: |V| is below the data there, so it is no envelope
};

/// The tightest |V| found that is nowhere below the magnitudes: as many poles as zeros (|V| levels off on both sides,
/// as the paper asks), pairs added one at a time where the excess is largest. Minimises the mean excess in dB under the
/// constraint (augmented Lagrangian over least squares, reweighted towards the mean). At least two frequencies, rising.
Envelope fit_envelope(std::span<const double> frequency_Hz, std::span<const double> magnitude_dB,
                      const EnvelopeSettings& settings = {});

/// How a given model stands to the magnitudes.
Envelope compare_envelope(const models::UncertaintyModel& model, std::span<const double> frequency_Hz,
                          std::span<const double> magnitude_dB);

/// The same after its gain was changed by as much as makes it touch the data from above; how a published table would do
/// on other data.
Envelope lifted_envelope(const models::UncertaintyModel& model, std::span<const double> frequency_Hz,
                         std::span<const double> magnitude_dB);

}  // namespace handloop::identify
