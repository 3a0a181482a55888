#pragma once

#include <optional>

#include "identify/explain/candidates.h"

namespace handloop::identify {

/// What is left when every catalogued effect has been tried, without a name.
struct Rest {
  Hypothesis hypothesis;         ///< the model with a `tabulated` effect at the arm, everything refitted
  double by_displacement = 0.0;  ///< shares of the table's power, weighted by where the motion was: function of x alone
  double by_velocity = 0.0;      ///< function of v alone
  double by_both = 0.0;          ///< what needs both
  std::string description;
};

/// Regression of the residual on a table of force over displacement and velocity at the arm, smoothed by its second
/// differences; the smoothing is chosen by cross-validation over blocks of the fitting part. Gauss-Newton, because the
/// table changes the motion it is read along. Nothing where it does not lower the training error.
std::optional<Rest> fit_rest(const Prediction& prediction, const Hypothesis& from);

}  // namespace handloop::identify
