#include "studies/tuning.h"

#include <algorithm>
#include <cmath>

#include "control/linear_plant.h"
#include "control/passivity.h"
#include "models/arm_uncertainty.h"
#include "studies/scenario_boundaries.h"
#include "studies/scenario_loop.h"

namespace handloop::studies {
namespace {

control::SampledLinearPlant linear_plant_of(const models::Scenario& scenario, const control::Loop& loop) {
  return {control::linear_plant(hand_model(scenario, scenario.wall.axis), {}, loop.plant.tip_mass_kg,
                                loop.plant.tip_damping_Ns_per_m),
          loop.timing.sample_time_s};
}

bool stable(const control::SampledLinearPlant& plant, const control::Loop& loop, double stiffness, double damping) {
  return control::closed_loop_poles(plant, loop.timing, {stiffness, damping}).cwiseAbs().maxCoeff() < 1.0;
}

/// Largest stiffness of the window that is stable, from nearly none upwards; 0 where a soft wall is unstable already.
double critical_stiffness(const control::SampledLinearPlant& plant, const control::Loop& loop, double damping,
                          double highest) {
  constexpr int kSteps = 24;
  double low = 0.0, high = 0.0;
  for (int i = 1; i <= kSteps && high == 0.0; ++i) {
    const double K = highest * std::pow(static_cast<double>(i) / kSteps, 2.0);
    (stable(plant, loop, K, damping) ? low : high) = K;
  }
  if (low == 0.0) return 0.0;
  if (high == 0.0) return control::Margins::kInfinity;
  for (int i = 0; i < 10; ++i) {
    const double middle = 0.5 * (low + high);
    (stable(plant, loop, middle, damping) ? low : high) = middle;
  }
  return low;
}

/// The boundary with effects: the critical stiffness at dampings over the window, in one piece where they join.
std::vector<control::BoundaryPiece> boundary(const control::SampledLinearPlant& plant, const control::Loop& loop,
                                             const control::GainWindow& window) {
  constexpr int kLevels = 60;
  std::vector<control::BoundaryPiece> pieces(1);
  for (int i = 0; i <= kLevels; ++i) {
    const double B = window.damping_low + (window.damping_high - window.damping_low) * i / kLevels;
    const double K = critical_stiffness(plant, loop, B, window.stiffness_high);
    if (std::isfinite(K)) {
      pieces.back().points.push_back({K, B, 0.0});
    } else if (!pieces.back().points.empty()) {
      pieces.emplace_back();
    }
  }
  return pieces;
}

/// The loop of a scenario whose device somebody holds by a five-parameter arm.
control::Loop held_loop(const models::Scenario& scenario) {
  auto loop = loop_of(scenario, scenario.wall.axis);
  if (!loop.plant.arm)
    throw InputError("arm: nobody holds the device by a five-parameter arm, so there is no population");
  return loop;
}

}  // namespace

NominalTuning tune_nominal(const models::Scenario& scenario) {
  NominalTuning result;
  result.axis = scenario.wall.axis;
  result.loop = loop_of(scenario, result.axis);
  control::require_valid(result.loop);
  result.with_effects = needs_linear_plant(scenario, result.axis);
  const auto plain = control::evaluate(result.loop);
  if (!result.with_effects) {
    result.margins = plain;
    result.curve = loop_curve(result.loop);
    return result;
  }
  if (result.loop.plant.arm) result.without_effects = plain;
  const auto plant = linear_plant_of(scenario, result.loop);
  result.margins = control::evaluate(plant, result.loop.timing, result.loop.gains);
  result.curve = loop_curve(plant, result.loop.timing, result.loop.gains);
  return result;
}

control::GainWindow near_window(const control::Loop& loop) {
  const auto round_up = [](double x) {
    const double decade = std::pow(10.0, std::floor(std::log10(x)));
    return decade * std::ceil(2 * x / decade - 1e-9) / 2;
  };
  const auto plant = control::sample_plant(loop.plant, loop.timing.sample_time_s);
  const double damping = round_up(std::max(3 * std::abs(loop.gains.damping_Ns_per_m), 4.0));
  double stiffness = std::max(1.5 * std::abs(loop.gains.stiffness_N_per_m), 100.0);
  if (loop.timing.delay_samples <= control::ClosedLoopVerdict::kMaxDelay) {
    for (int i = 0; i <= 6; ++i) {
      const double K = control::critical_stiffness(plant, loop.timing, damping * i / 6);
      if (std::isfinite(K)) stiffness = std::max(stiffness, 1.2 * K);
    }
  }
  return {0, round_up(stiffness), 0, damping};
}

RobustTuning tune_robust(const models::Scenario& scenario, const std::optional<control::GainWindow>& window) {
  RobustTuning result;
  const auto axis = scenario.wall.axis;
  const auto loop = loop_of(scenario, axis);
  control::require_valid(loop);
  result.required_damping_Ns_per_m = control::colgate_required_damping(loop.timing, loop.gains);
  result.window = window ? *window : near_window(loop);
  if (loop.plant.arm) {
    const auto peak = [&](models::UncertaintySet set) {
      return control::unstructured_peak(loop.plant, loop.timing, loop.gains, models::uncertainty(axis, set), 0.6, 30);
    };
    result.peak67 = peak(models::UncertaintySet::percentile67);
    result.peak_maximum = peak(models::UncertaintySet::maximum);
  }
  const double B = loop.gains.damping_Ns_per_m;
  if (needs_linear_plant(scenario, axis) || loop.timing.delay_samples > control::ClosedLoopVerdict::kMaxDelay) {
    const auto plant = linear_plant_of(scenario, loop);
    result.critical_stiffness_N_per_m = critical_stiffness(plant, loop, B, 4 * result.window.stiffness_high);
    result.boundary = boundary(plant, loop, result.window);
  } else {
    const auto plant = control::sample_plant(loop.plant, loop.timing.sample_time_s);
    result.critical_stiffness_N_per_m = control::critical_stiffness(plant, loop.timing, B);
    result.boundary = control::trace_boundary(plant, loop.timing, result.window);
  }
  return result;
}

control::PopulationMargins tune_population(const models::Scenario& scenario, std::size_t arms, std::uint64_t seed,
                                           unsigned threads) {
  const auto loop = held_loop(scenario);
  return control::population_margins(models::ArmPopulation(scenario.wall.axis), loop, arms, seed, 5, threads);
}

std::optional<PopulationLimits> population_limits(const models::Scenario& scenario, std::size_t arms,
                                                  std::uint64_t seed, const control::GainWindow& window,
                                                  std::stop_token stop, const Progress& progress) {
  const auto loop = held_loop(scenario);
  const models::ArmPopulation population(scenario.wall.axis);
  PopulationLimits result;
  if (loop.timing.delay_samples > control::ClosedLoopVerdict::kMaxDelay) return result;
  constexpr std::size_t kLevels = 16;
  const std::size_t total = arms + kLevels + 1;
  std::size_t done = 0;
  const auto stopped = [&] {
    if (progress) progress(++done, total);
    return stop.stop_requested();
  };
  const double span = window.damping_high - window.damping_low;
  for (std::size_t i = 0; i < arms; ++i) {
    auto plant = loop.plant;
    plant.arm = population.sample(seed, i);
    // the golden ratio spreads dampings evenly however many arms there are
    const double B = window.damping_low + span * std::fmod(0.6180339887498949 * static_cast<double>(i + 1), 1.0);
    const double K =
        control::critical_stiffness(control::sample_plant(plant, loop.timing.sample_time_s), loop.timing, B);
    if (std::isfinite(K)) result.cloud.push_back({K, B});
    if (stopped()) return std::nullopt;
  }
  constexpr std::size_t kForTheLine = 400;
  for (std::size_t i = 0; i <= kLevels; ++i) {
    auto level = loop;
    level.gains.damping_Ns_per_m = window.damping_low + span * static_cast<double>(i) / kLevels;
    const double K =
        control::population_permitted_stiffness(population, level, std::min(arms, kForTheLine), seed, 0.95, 1);
    if (std::isfinite(K)) result.line95.push_back({K, level.gains.damping_Ns_per_m});
    if (stopped()) return std::nullopt;
  }
  return result;
}

}  // namespace handloop::studies
