#pragma once

#include <optional>
#include <string>
#include <vector>

#include "studies/tuning.h"

/// What the numbers mean, in words and in the order a person needs them.
namespace handloop::ui {

enum class Outlook {
  stable,    ///< nominal arm and at least 95 % of the sampled arms
  doubtful,  ///< nominal arm only, or the population is not known yet
  unstable
};

struct Verdict {
  Outlook outlook = Outlook::doubtful;
  std::string word;      ///< "STABLE" or "UNSTABLE": comes first
  std::string sentence;  ///< why, and for whom
};
Verdict verdict_of(const studies::NominalTuning& nominal, const std::optional<control::PopulationMargins>& population);

/// One figure with its name, as a table shows it. `good` colours it: empty where that is no question.
struct Figure {
  std::string name, value, hint;
  std::optional<bool> good;
};
/// Gain, phase, delay, disk margin, robust peak, population and critical stiffness. Of an unstable loop no margin is
/// named.
std::vector<Figure> figures_of(const studies::NominalTuning& nominal,
                               const std::optional<studies::RobustTuning>& robust,
                               const std::optional<control::PopulationMargins>& population);

}  // namespace handloop::ui
