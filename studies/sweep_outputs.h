#pragma once

#include <string>
#include <vector>

#include "studies/sweep.h"
#include "studies/sweep_compare.h"
#include "studies/sweep_plan.h"
#include "studies/sweep_statistics.h"

namespace handloop::studies {

/// What the files of a finished sweep are made of. The same contents give the same bytes.
struct SweepContents {
  SweepSettings settings;
  std::vector<SweepCondition> conditions;
  std::vector<SweepPoint> points;
  std::vector<PointStatistics> cells;
  std::vector<RequirementOutcome> requirements;
  std::optional<SweepComparison> comparison;
};

std::string sweep_summary_json(const SweepContents& contents);
std::string sweep_junit_xml(const SweepContents& contents);
/// Throws RequirementError where gnuplot is missing.
std::string sweep_report_html(const SweepContents& contents);

}  // namespace handloop::studies
