#pragma once

#include <string>
#include <vector>

#include "identify/explain/prediction.h"

namespace handloop::identify {

/// What no model driven by the input can predict.
struct NoiseFloor {
  double rmse = 0.0;    ///< of the output, same unit
  double sensor = 0.0;  ///< white part: the output's spectrum where the excitation has long ended
  double wander = 0.0;  ///< slow part below 0.5 Hz that is not coherent with the input
  std::string how;
};

/// From the output and the base model's residual, before any candidate is tried.
NoiseFloor estimate_noise_floor(const Prediction& prediction, const models::AxisModel& base);

/// Root mean square that the output's noise alone leaves in the filtered error: no model comes below it. From the
/// quietest of three bands above the excitation, so that a sensor noisier at high frequency is not taken for a floor.
double filtered_noise(const Prediction& prediction, const models::AxisModel& base);

/// A spectral line of a residual that the input does not explain.
struct SpectralLine {
  double frequency_Hz = 0.0;
  double bandwidth_Hz = 0.0;  ///< over which it stands above half of its peak
  double ratio = 0.0;         ///< of its power to that of the spectrum around it
  double coherence = 0.0;     ///< with the input
  double force_rms = 0.0;     ///< of the line as a force on the arm, N
  bool significant = false;
};

/// Looks for tremor, 3 to 16 Hz, in a residual sampled like the recording. `response`: by how much a force on the arm
/// at a frequency in Hz moves the residual. A line has to stand out as a force and as it was recorded: the peak of a
/// hardly damped arm is the arm's, whatever shakes it.
SpectralLine find_line(std::span<const double> residual, std::span<const double> input, double sample_time_s,
                       const std::function<double(double)>& response);

}  // namespace handloop::identify
