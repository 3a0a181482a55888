#pragma once

#include <string>
#include <vector>

#include "studies/experiment.h"

namespace handloop::studies {

/// Five seconds of a trial, thinned, for the report.
struct TrialExcerpt {
  std::vector<double> time_s, force_N, position_m;
};
TrialExcerpt excerpt(const TrialRecord& record);

/// What is kept of a trial once its file is written.
struct TrialOutcome {
  double cap_N = 0.0;
  double stimulus_rms_N = 0.0;
  std::size_t clipped_samples = 0;
  int repeats = 0;  ///< at half the force each time
  double force_rms_N = 0.0;
  double position_rms_m = 0.0;
  TrialExcerpt seconds;
};

/// The page that goes with the recordings: the protocol, five seconds of each axis (the paper's Figure 3) and every
/// trial.
std::string experiment_report(const ExperimentRequest& request, const std::vector<Trial>& trials,
                              const std::vector<TrialOutcome>& outcomes);

}  // namespace handloop::studies
