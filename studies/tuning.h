#pragma once

#include <cstdint>
#include <optional>
#include <stop_token>
#include <vector>

#include "control/population_margins.h"
#include "control/stability_boundary.h"
#include "control/unstructured.h"
#include "models/scenario.h"
#include "studies/progress.h"
#include "studies/stability_plots.h"

/// What somebody who turns a gain wants to see, in three helpings by how long they take: the nominal loop (below a
/// millisecond without effects), its robustness and where it ends (milliseconds), the population (tens of
/// milliseconds). Each is a plain value made from a scenario, on whatever thread.
namespace handloop::studies {

/// The wall's axis with the arm that holds it, effects included by their linear stand-ins.
struct NominalTuning {
  models::Axis axis = models::Axis::z;
  control::Loop loop;         ///< effects left out
  bool with_effects = false;  ///< `margins` and `curve` are then of the plant with them
  control::Margins margins;
  std::optional<control::Margins> without_effects;
  LoopCurve curve;
};

/// Throws InputError where the scenario's device has no tip inertia, the loop is not possible, or an effect has no
/// linear stand-in.
NominalTuning tune_nominal(const models::Scenario& scenario);

/// Robustness of the nominal loop and the boundary of stability about it.
struct RobustTuning {
  std::optional<control::UnstructuredPeak> peak67, peak_maximum;  ///< of |W_u T|, 0.6 to 30 Hz; none without an arm
  double critical_stiffness_N_per_m = 0.0;                        ///< at the scenario's damping; infinity where none
  double required_damping_Ns_per_m = 0.0;  ///< for passivity (Colgate and Schenkel, with the delay)
  control::GainWindow window;
  std::vector<control::BoundaryPiece> boundary;  ///< of the plant with its effects
};
/// The window must show the present gains; none: near_window. Throws InputError as tune_nominal.
RobustTuning tune_robust(const models::Scenario& scenario, const std::optional<control::GainWindow>& window = {});

/// The part of the K-B plane about the gains where a designer works: three times the damping, and as much stiffness as
/// can be stable there. (natural_window of studies/scenario_boundaries.h shows the whole region of stability.)
control::GainWindow near_window(const control::Loop& loop);

/// Margins of the sampled arms in the loop of the scenario, effects left out. Throws InputError as tune_nominal; a
/// scenario without a five-parameter arm on its axis has no population (InputError).
control::PopulationMargins tune_population(const models::Scenario& scenario, std::size_t arms, std::uint64_t seed,
                                           unsigned threads = 0);

/// A point of the K-B plane.
struct GainPoint {
  double stiffness_N_per_m = 0.0, damping_Ns_per_m = 0.0;
};

/// Where the stability of each sampled arm ends, effects left out.
struct PopulationLimits {
  std::vector<GainPoint> cloud;   ///< each arm's critical stiffness, at a damping of its own spread over the window
  std::vector<GainPoint> line95;  ///< 95 % of the arms are stable below
};
/// Empty where a stop was asked for meanwhile. Throws InputError as tune_population.
std::optional<PopulationLimits> population_limits(const models::Scenario& scenario, std::size_t arms,
                                                  std::uint64_t seed, const control::GainWindow& window,
                                                  std::stop_token stop = {}, const Progress& progress = {});

}  // namespace handloop::studies
