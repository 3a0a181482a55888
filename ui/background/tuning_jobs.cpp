#include "ui/background/tuning_jobs.h"

#include <chrono>

#include "models/errors.h"
#include "studies/scenario_loop.h"
#include "ui/state/gain_map.h"

namespace handloop::ui {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

}  // namespace

void TuningJobs::start(const models::Scenario& scenario) {
  problem_.clear();
  const auto begin = Clock::now();
  try {
    if (studies::needs_linear_plant(scenario, scenario.wall.axis)) {
      nominal_job_.request(
          [scenario](JobContext&) {
            const auto from = Clock::now();
            auto value = studies::tune_nominal(scenario);
            return std::optional(Timed<studies::NominalTuning>{std::move(value), seconds_since(from)});
          },
          false);
    } else {
      nominal_job_.cancel();
      nominal_ = studies::tune_nominal(scenario);
      nominal_seconds_ = seconds_since(begin);
    }
  } catch (const InputError& error) {
    problem_ = error.what();
    nominal_.reset(), robust_.reset(), population_.reset();
    return;
  }
  if (scenario.wall.axis != axis_) robust_.reset(), population_.reset();
  axis_ = scenario.wall.axis;
  // the map keeps its window while it shows the gains: a map that jumps under the mouse is no map
  std::optional<control::GainWindow> window;
  if (robust_ && shows(robust_->window, scenario.loop.stiffness_N_per_m, scenario.loop.damping_Ns_per_m))
    window = robust_->window;
  robust_job_.request([scenario, window](JobContext&) { return std::optional(studies::tune_robust(scenario, window)); },
                      false);
}

void TuningJobs::sample(const models::Scenario& scenario) {
  if (!scenario.arm.attached || scenario.arm.rigid[static_cast<std::size_t>(axis_)]) {
    population_job_.cancel();
    population_.reset();
    return;
  }
  studies::PopulationRequest request{arms, seed, robust_->window, 0};
  population_job_.request(
      [scenario, request](JobContext& context) -> std::optional<Timed<studies::PopulationTuning>> {
        const auto from = Clock::now();
        auto result = studies::tune_population(
            scenario, request, context.stop_token(), [&context](std::size_t done, std::size_t total) {
              context.progress(static_cast<double>(done) / static_cast<double>(total));
            });
        if (!result) return std::nullopt;
        return Timed<studies::PopulationTuning>{std::move(*result), seconds_since(from)};
      },
      false);
}

void TuningJobs::follow(const models::Scenario& scenario, std::uint64_t revision) {
  if (revision != revision_) {
    revision_ = revision;
    start(scenario);
  }
  if (auto answer = nominal_job_.take()) {
    nominal_ = std::move(answer->value);
    nominal_seconds_ = answer->seconds;
  }
  if (auto answer = robust_job_.take()) robust_ = std::move(*answer);
  if (auto answer = population_job_.take()) {
    population_ = std::move(answer->value);
    population_seconds_ = answer->seconds;
  }
  for (auto error : {nominal_job_.take_error(), robust_job_.take_error(), population_job_.take_error()}) {
    if (!error.empty()) problem_ = std::move(error);
  }
  if (robust_ && !robust_job_.busy() && population_revision_ != revision_) {
    population_revision_ = revision_;
    sample(scenario);
  }
}

}  // namespace handloop::ui
