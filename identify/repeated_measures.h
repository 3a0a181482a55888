#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace handloop::identify {

/// Two conditions compared within subjects.
struct PairedComparison {
  Eigen::Index first = 0, second = 0;  ///< columns
  double mean_difference = 0.0;        ///< second minus first
  double t = 0.0;                      ///< paired t, n - 1 degrees of freedom
  double p = 1.0;                      ///< two-sided, of this comparison alone
  double p_holm_sidak = 1.0;           ///< adjusted for all pairs (step-down)
};

/// One-way repeated-measures analysis of variance.
struct RepeatedMeasures {
  Eigen::Index subjects = 0, conditions = 0;
  double F = 0.0;
  double numerator_freedom = 0.0, denominator_freedom = 0.0;  ///< uncorrected
  double p = 1.0;                                             ///< under sphericity
  double epsilon = 1.0;                                       ///< Greenhouse and Geisser, 1/(conditions-1) .. 1
  double p_greenhouse_geisser = 1.0;
  std::vector<PairedComparison> pairs;
};

/// `values`: subjects by conditions, complete. Throws std::invalid_argument for fewer than two of either or for a value
/// that is not finite. Where nothing varies within subjects F is 0 and every p is 1.
RepeatedMeasures repeated_measures(const Eigen::MatrixXd& values);

}  // namespace handloop::identify
