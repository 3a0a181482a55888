#include "studies/arm_survey.h"

#include <cmath>
#include <numbers>

#include "control/closed_loop_verdict.h"
#include "control/margins.h"
#include "control/stability_boundary.h"
#include "models/arm_uncertainty.h"
#include "studies/scenario_loop.h"

namespace handloop::studies {

std::optional<ArmSurvey> survey_arms(const models::Scenario& scenario, std::size_t count, std::uint64_t seed,
                                     std::stop_token stop, const Progress& progress) {
  constexpr std::size_t kFan = 200;
  ArmSurvey survey;
  survey.axis = scenario.wall.axis;
  survey.seed = seed;
  auto loop = loop_of(scenario, survey.axis);
  control::require_valid(loop);
  const models::ArmPopulation population(survey.axis);
  const bool with_limits = loop.timing.delay_samples <= control::ClosedLoopVerdict::kMaxDelay;
  for (std::size_t i = 0; i < count; ++i) {
    loop.plant.arm = population.sample(seed, i);
    const auto plant = control::sample_plant(loop.plant, loop.timing.sample_time_s);
    const auto margins = control::evaluate(plant, loop.timing, loop.gains);
    const double limit =
        with_limits ? control::critical_stiffness(plant, loop.timing, loop.gains.damping_Ns_per_m) : std::nan("");
    survey.arms.push_back({*loop.plant.arm, margins.stable, margins.stable ? margins.disk_alpha : 0.0, limit});
    if (progress) progress(i + 1, count + 1);
    if (stop.stop_requested()) return std::nullopt;
  }
  survey.bode = arm_bode(population, {.count = kFan, .seed = seed, .literature = {"all"}});
  const auto& maximum = models::uncertainty(survey.axis, models::UncertaintySet::maximum);
  const auto& percentile67 = models::uncertainty(survey.axis, models::UncertaintySet::percentile67);
  constexpr int kPoints = 240;
  for (int i = 0; i <= kPoints; ++i) {
    const double f = 0.6 * std::pow(50.0, static_cast<double>(i) / kPoints);
    const std::complex<double> s(0, 2 * std::numbers::pi * f);
    survey.envelope_Hz.push_back(f);
    survey.maximum_dB.push_back(20 * std::log10(std::abs(maximum(s))));
    survey.percentile67_dB.push_back(20 * std::log10(std::abs(percentile67(s))));
  }
  return survey;
}

}  // namespace handloop::studies
