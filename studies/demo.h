#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "control/population_margins.h"
#include "control/stability_boundary.h"
#include "models/scenario.h"
#include "studies/loop_trace.h"
#include "studies/progress.h"

/// The main job from end to end, on one page: a held Phantom at a virtual wall, its margins over the measured arms, and
/// what happens beyond them.
namespace handloop::studies {

struct DemoOptions {
  std::size_t arms = 2000;  ///< of the population
  std::uint64_t seed = 1;
};

/// Over the plane of wall stiffness and damping: which share of the sampled arms is stable.
struct StabilityMap {
  std::vector<double> stiffness_N_per_m, damping_Ns_per_m;
  std::vector<double> stable_share;  ///< damping rows of stiffness columns, 0 to 1
  std::vector<control::BoundaryPiece> nominal_boundary;
};

/// Margins of one axis with the scenario's gains: of its own arm, and of the population.
struct AxisMargins {
  models::Axis axis = models::Axis::z;
  control::Loop loop;
  control::Margins nominal;
  control::PopulationMargins population;
  double critical_stiffness_N_per_m = 0.0;       ///< at the scenario's damping
  std::vector<double> sampled_critical_N_per_m;  ///< of every sampled arm
  double permitted_stiffness_N_per_m = 0.0;      ///< the stiffest wall that 95 % of the arms hold
};

struct Demo {
  models::Scenario scenario;
  DemoOptions options;
  LoopTrace wall;    ///< the scenario as it is
  LoopTrace beyond;  ///< as a bilateral spring, stiffer than its limit
  double beyond_stiffness_N_per_m = 0.0;
  std::vector<AxisMargins> axes;  ///< x, y, z
  StabilityMap map;               ///< of the wall's axis
  const AxisMargins& wall_axis() const { return axes[static_cast<std::size_t>(scenario.wall.axis)]; }
};

/// Throws InputError where the scenario cannot be simulated.
Demo run_demo(const models::Scenario& scenario, const DemoOptions& options, const Progress& progress = {});

/// Writes report.html, summary.json and closed_loop.csv into the directory. Throws InputError where that is not
/// possible.
void write_demo(const Demo& demo, const std::filesystem::path& directory);

}  // namespace handloop::studies
