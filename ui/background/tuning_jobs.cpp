#include "ui/background/tuning_jobs.h"

#include <chrono>

#include "models/errors.h"
#include "studies/scenario_boundaries.h"
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
  const auto axis = scenario.wall.axis;
  const auto begin = Clock::now();
  try {
    if (studies::needs_linear_plant(scenario, axis)) {
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
    nominal_.reset(), robust_.reset(), population_.reset(), limits_.reset();
    return;
  }
  if (axis != axis_) robust_.reset(), population_.reset(), limits_.reset();
  axis_ = axis;
  // the map keeps its window while it shows the gains: a map that jumps under the mouse is no map
  std::optional<control::GainWindow> window;
  if (robust_ && shows(robust_->window, scenario.loop.stiffness_N_per_m, scenario.loop.damping_Ns_per_m))
    window = robust_->window;
  robust_job_.request(
      [scenario, window, whole = whole_map_](JobContext&) {
        if (window || !whole) return std::optional(studies::tune_robust(scenario, window));
        return std::optional(
            studies::tune_robust(scenario, studies::natural_window(studies::loop_of(scenario, scenario.wall.axis))));
      },
      false);
  if (!scenario.arm.attached || scenario.arm.rigid[static_cast<std::size_t>(axis)]) {
    population_job_.cancel();
    population_.reset();
    return;
  }
  population_job_.request(
      [scenario](JobContext&) {
        const auto from = Clock::now();
        auto value = studies::tune_population(scenario, kArms, kSeed);
        return std::optional(Timed<control::PopulationMargins>{std::move(value), seconds_since(from)});
      },
      false);
}

void TuningJobs::take_answers() {
  if (auto answer = nominal_job_.take()) {
    nominal_ = std::move(answer->value);
    nominal_seconds_ = answer->seconds;
  }
  if (auto answer = robust_job_.take()) robust_ = std::move(*answer);
  if (auto answer = population_job_.take()) {
    population_ = std::move(answer->value);
    population_seconds_ = answer->seconds;
  }
  if (auto answer = limits_job_.take()) limits_ = std::move(*answer);
  for (auto error : {nominal_job_.take_error(), robust_job_.take_error(), population_job_.take_error()}) {
    if (!error.empty()) problem_ = std::move(error);
  }
}

void TuningJobs::follow(const models::Scenario& scenario, std::uint64_t revision) {
  if (revision != revision_) {
    revision_ = revision;
    start(scenario);
  }
  take_answers();
  if (!robust_ || robust_job_.busy() || limits_revision_ == revision_) return;
  limits_revision_ = revision_;
  if (!scenario.arm.attached || scenario.arm.rigid[static_cast<std::size_t>(axis_)]) {
    limits_job_.cancel();
    limits_.reset();
    return;
  }
  limits_job_.request(
      [scenario, window = robust_->window](JobContext& context) {
        return studies::population_limits(scenario, kArms, kSeed, window, context.stop_token());
      },
      false);
}

void TuningJobs::show_whole_map(bool whole) {
  whole_map_ = whole;
  robust_.reset();
  limits_.reset();
  revision_ = 0;
}

}  // namespace handloop::ui
