#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "control/arm_box.h"
#include "control/linear_plant.h"
#include "control/margins.h"
#include "control/multi_axis.h"
#include "control/passivity.h"
#include "control/population_margins.h"
#include "control/unstructured.h"
#include "models/arm_population.h"
#include "models/scenario.h"
#include "studies/progress.h"

/// The stability question of a scenario answered from every side: `margins --scenario`.
namespace handloop::studies {

struct ScenarioMarginsRequest {
  std::size_t arms = 2000;  ///< sampled
  std::uint64_t seed = 1;
  models::PercentileReading percentiles = models::PercentileReading::ecdf;
  bool permitted_stiffness = true;  ///< search for what each test permits (a few seconds)
  unsigned jobs = 0;
};

/// One line of the table that puts the tests side by side.
struct PermittedStiffness {
  std::string key;   ///< of the JSON: "nominal", "structured_95", ...
  std::string test;  ///< as people read it
  std::string assumes;
  std::optional<bool> holds;       ///< at the scenario's own gains
  double stiffness_N_per_m = 0.0;  ///< largest K with the scenario's B; NaN where it was not searched for
};

struct UnstructuredResult {
  control::UnstructuredPeak narrow, wide;  ///< 0.6 to 30 Hz, as identified; 0.01 to 400 Hz
  bool robust = false;                     ///< narrow peak below 1 and nominal stable
  bool robust_wide = false;
};

struct ScenarioMargins {
  models::Scenario scenario;
  models::Axis axis = models::Axis::z;  ///< of the wall
  control::Loop loop;                   ///< the wall's axis: tip at the pose, nominal arm, timing, gains
  bool has_effects = false;  ///< then `nominal` is of the plant with them, `without_effects` of the plain arm
  control::Margins nominal;
  std::optional<control::Margins> without_effects;
  std::array<std::optional<control::Margins>, 3> by_axis;  ///< the same wall on each axis
  control::MultiAxisMargins all_axes;                      ///< the same wall on all axes at once
  double critical_stiffness_N_per_m = 0.0;
  double ray_limit = 0.0;  ///< Z-width along the ray of the gains: stable up to this many times (K, B)

  // what follows is of the five-parameter arm; empty where the scenario has none
  std::optional<UnstructuredResult> maximum, percentile67;
  std::optional<control::StructuredMu> mu67, mu95, mu_extremes;
  std::optional<control::PopulationMargins> population;

  double device_damping_Ns_per_m = 0.0, coulomb_N = 0.0, resolution_m = 0.0;  ///< at the tip along the axis
  double required_damping_Ns_per_m = 0.0;                                     ///< Colgate and Schenkel, with this delay
  double required_damping_no_delay_Ns_per_m = 0.0;
  control::AbbottOkamura abbott_okamura;
  control::Diolaiti diolaiti;
  control::Llewellyn llewellyn;
  std::vector<PermittedStiffness> permitted;
};

/// Throws InputError where the scenario's device has no tip inertia in closed form or its loop is not possible.
ScenarioMargins scenario_margins(const models::Scenario& scenario, const ScenarioMarginsRequest& request,
                                 const Progress& progress = {});

/// The same wall on all three axes at the scenario's pose, the tip's inertia and damping coupling them.
control::MultiAxisMargins multi_axis_margins(const models::Scenario& scenario);

/// Machine form: CONTRACT.md's keys and more.
nlohmann::ordered_json to_json(const ScenarioMargins& result);

/// Table for people.
std::string to_text(const ScenarioMargins& result);

/// report.html with Bode and Nyquist plots, the K-B map and its families, the table and the population; boundaries.csv,
/// loop_response.csv, margins.json, population.csv and worst_arm_N.toml beside it. Throws InputError where the
/// directory cannot be written.
void write_scenario_margins(const ScenarioMargins& result, const ScenarioMarginsRequest& request,
                            const std::string& directory);

}  // namespace handloop::studies
