#pragma once

#include <filesystem>
#include <vector>

#include "device/record.h"
#include "studies/run.h"

namespace handloop::studies {

/// What the pictures of a run need: some signals of every sample.
struct RunTrace {
  std::vector<double> time_s, position_m, wanted_N, written_N, sensed_N, energy_J;
  void add(const device::StepRecord& record, int row, double home_m);
};

/// summary.json, as CONTRACT says and more.
std::string run_summary_json(const RunOptions& options, const RunOutcome& outcome);

/// report.html. Throws RequirementError where gnuplot is missing.
void write_run_report(const std::filesystem::path& path, const RunOptions& options, const RunOutcome& outcome,
                      const RunTrace& trace);

}  // namespace handloop::studies
