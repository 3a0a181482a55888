#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "device/record.h"
#include "studies/run.h"

namespace handloop::studies {

/// What the pictures of a run need: some signals of every sample.
struct RunTrace {
  std::uint64_t every = 1;  ///< keeps one sample in so many, so that long runs fit in memory
  std::uint64_t seen = 0;
  std::vector<double> time_s, position_m, wanted_N, written_N, sensed_N, energy_J;
  void add(const device::StepRecord& record, int row, double home_m);
};

/// summary.json, as CONTRACT says and more.
std::string run_summary_json(const RunOptions& options, const RunOutcome& outcome);

/// report.html. Throws RequirementError where gnuplot is missing.
void write_run_report(const std::filesystem::path& path, const RunOptions& options, const RunOutcome& outcome,
                      const RunTrace& trace);

}  // namespace handloop::studies
