#pragma once

#include <cstdint>
#include <optional>
#include <stop_token>
#include <vector>

#include "models/scenario.h"
#include "studies/arm_bode.h"
#include "studies/progress.h"

/// Sampled arms of one axis, and what each of them does to the loop of a scenario.
namespace handloop::studies {

struct SurveyedArm {
  models::ArmParameters arm;
  bool stable = false;
  double disk_alpha = 0.0;                  ///< 0 where unstable
  double critical_stiffness_N_per_m = 0.0;  ///< at the scenario's damping; infinity where none
};

struct ArmSurvey {
  models::Axis axis = models::Axis::z;
  std::uint64_t seed = 1;
  std::vector<SurveyedArm> arms;
  ArmBode bode;                                                  ///< with a fan of some of the arms
  std::vector<double> envelope_Hz, maximum_dB, percentile67_dB;  ///< |W_u| of both sets, 0.6 to 30 Hz
};

/// Arms 0 to count - 1 of the seed in the scenario's loop (effects left out), with the `literature` of Table V beside
/// them. Empty where a stop was asked for. Throws InputError where the scenario has no loop.
std::optional<ArmSurvey> survey_arms(const models::Scenario& scenario, std::size_t count, std::uint64_t seed,
                                     std::stop_token stop = {}, const Progress& progress = {});

}  // namespace handloop::studies
