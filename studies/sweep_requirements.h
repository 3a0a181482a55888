#pragma once

#include <optional>
#include <string>
#include <vector>

#include "studies/sweep.h"
#include "studies/sweep_plan.h"
#include "studies/sweep_statistics.h"

namespace handloop::studies {

/// What a team demands of every point, or of the points at one pair of gains:
///   p_stable>=0.95            p_stable_lo95>=0.95       (lower end of its Clopper-Pearson interval)
///   gm_up_p05>=2\@k=800,b=2    sm_min>0.3
/// Quantities: p_stable, p_stable_lo95, p_stable_hi95, rho_p95, and gm_up, pm_deg, dm_s, sm, disk_alpha each with _min,
/// _p05 or _p50. A margin of an unstable arm is less than any number.
struct Requirement {
  enum class Comparison { at_least, at_most, above, below };

  std::string expression;
  std::string quantity;
  Comparison comparison = Comparison::at_least;
  double limit = 0.0;
  std::optional<double> stiffness_N_per_m, damping_Ns_per_m;
};

/// Throws InputError saying what is wrong with the expression and what would be right.
Requirement parse_requirement(const std::string& expression);

/// Throws InputError where no point has the gains that a requirement names (within 0.1 %, as people type them).
void require_place(const Requirement& requirement, const std::vector<SweepPoint>& points);

/// Throws as require_place.
RequirementOutcome check_requirement(const Requirement& requirement, const std::vector<SweepCondition>& conditions,
                                     const std::vector<SweepPoint>& points, const std::vector<PointStatistics>& cells);

/// The named quantity of a point; NaN: the margin of an unstable arm, or unknown to the method.
double quantity_of(const PointStatistics& cell, const std::string& quantity);

/// "axis z, delay 1, k = 800 N/m, b = 2 Ns/m".
std::string describe_point(const SweepCondition& condition, const SweepPoint& point);

}  // namespace handloop::studies
