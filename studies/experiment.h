#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "models/arm_population.h"
#include "models/axis_model.h"
#include "models/scenario.h"
#include "studies/experiment_trial.h"
#include "studies/progress.h"

/// The arm paper's experiment: every subject, grip force and axis once, in an order of its own for each subject.
namespace handloop::studies {

struct ExperimentRequest {
  std::vector<models::Axis> axes{models::Axis::x, models::Axis::y, models::Axis::z};
  std::size_t subjects = 15;
  std::vector<int> grips_N{1, 2, 3};
  std::uint64_t seed = 1;
  StimulusKind stimulus = StimulusKind::noise;
  double stimulus_rms_N = 0.0;  ///< 0: a third of the force cap of the axis
  double duration_s = 60.0;
  models::PercentileReading percentiles = models::PercentileReading::ecdf;
  /// Recorded alone, effects included, in the place of arms of the population.
  std::optional<models::AxisModel> arm;
  /// Device, electronics, wander and where force is sensed; its arms are replaced by the subjects'.
  models::Scenario rig;
  unsigned jobs = 0;  ///< trials at a time; 0: as many as there are cores
};

/// One trial before it is run. Arms of all three axes: those not excited are free, but the hand is there.
struct Trial {
  std::size_t number = 1;   ///< from 1, in the order they are run
  std::size_t subject = 1;  ///< from 1
  int grip_N = 2;
  models::Axis axis = models::Axis::x;
  std::array<models::ArmParameters, 3> arms;
  std::uint64_t seed = 1;  ///< of stimulus, noise and wander
};

/// Arms are drawn independently for each subject, grip force and axis: what two grips of one person have in common was
/// not published. Throws InputError where there is nothing to do.
std::vector<Trial> plan_trials(const ExperimentRequest& request);

/// The scenario a trial runs in.
models::Scenario trial_scenario(const ExperimentRequest& request, const Trial& trial);

struct ExperimentSummary {
  std::size_t trials = 0;
  double recorded_s = 0.0;  ///< of simulated time
  double wall_time_s = 0.0;
  std::size_t clipped_samples = 0;
};

/// Runs all trials and writes trial_%03d.csv, index.csv and report.html into the directory, which appears complete or
/// not at all. The same request gives the same bytes whatever jobs is. Throws InputError and RequirementError.
ExperimentSummary run_experiment(const ExperimentRequest& request, const std::filesystem::path& directory,
                                 const Progress& progress = {});

}  // namespace handloop::studies
