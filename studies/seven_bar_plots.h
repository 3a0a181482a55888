#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "io/plot.h"
#include "models/scenario.h"
#include "studies/seven_bar_margins.h"
#include "studies/seven_bar_measurement.h"

namespace handloop::studies {

/// What a picture book of the loop needs: predictions, and measurements on the simulated linkage (half a minute).
struct SevenBarEvidence {
  SevenBarMargins margins;
  std::vector<PrimaryPoint> primary;
  std::vector<std::pair<double, double>> growth;  ///< alpha in y and simulated growth rate, 1/s
  double simulated_limit_y = 0.0;                 ///< where it changes its sign
};
SevenBarEvidence seven_bar_evidence(const models::Scenario& scenario);

/// Each with a name fit for a file: the arm (their Fig. 8), the primary loop against its sensitivities, performance,
/// Nyquist's curve, G_c's impulse response, growth over alpha.
std::vector<std::pair<std::string, io::Plot>> seven_bar_plots(const models::Scenario& scenario,
                                                              const SevenBarEvidence& evidence);

/// DIR/margins.json and DIR/report.html. Throws RequirementError where gnuplot is missing.
void write_seven_bar_margins(const models::Scenario& scenario, const std::filesystem::path& directory);
/// The same pictures and those of the experiment, as SVG files: what docs/seven_bar.md shows.
void write_seven_bar_figures(const models::Scenario& scenario, const std::filesystem::path& directory);

}  // namespace handloop::studies
