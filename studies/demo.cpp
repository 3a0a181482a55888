#include "studies/demo.h"

#include <algorithm>
#include <cmath>

#include "control/closed_loop_verdict.h"
#include "models/arm_population.h"
#include "models/errors.h"
#include "models/scenario_tip.h"

namespace handloop::studies {
namespace {

/// Wall of the second run: so much stiffer than the limit.
constexpr double kBeyond = 1.2;
constexpr std::size_t kMapColumns = 61;
constexpr std::size_t kMapRows = 41;
/// Arms a point of the map: enough for steps of a quarter of a percent.
constexpr std::size_t kMapArms = 400;

control::Loop loop_of(const models::Scenario& scenario, models::Axis axis) {
  if (!scenario.arm.attached || scenario.arm.rigid[static_cast<std::size_t>(axis)]) {
    throw InputError("scenario '" + scenario.name +
                     "': the demo compares arms, so every axis needs a five-parameter arm");
  }
  const auto tip = models::tip_of(scenario, axis);
  return {{tip.mass_kg, tip.damping_Ns_per_m, scenario.arm.axes[static_cast<std::size_t>(axis)]},
          {scenario.loop.sample_time_s, scenario.loop.delay_samples, scenario.loop.cutoff_Hz},
          {scenario.loop.stiffness_N_per_m, scenario.loop.damping_Ns_per_m}};
}

/// K_cr of the loop with another arm.
double critical_stiffness(const control::Loop& loop, const models::ArmParameters& arm) {
  auto plant = loop.plant;
  plant.arm = arm;
  return control::critical_stiffness(sample_plant(plant, loop.timing.sample_time_s), loop.timing,
                                     loop.gains.damping_Ns_per_m);
}

AxisMargins margins_of(const models::Scenario& scenario, models::Axis axis, const DemoOptions& options) {
  const models::ArmPopulation population(axis);
  AxisMargins result;
  result.axis = axis;
  result.loop = loop_of(scenario, axis);
  result.nominal = evaluate(result.loop);
  result.critical_stiffness_N_per_m = critical_stiffness(result.loop, *result.loop.plant.arm);
  result.population = population_margins(population, result.loop, options.arms, options.seed);
  for (std::size_t i = 0; i < options.arms; ++i) {
    result.sampled_critical_N_per_m.push_back(critical_stiffness(result.loop, population.sample(options.seed, i)));
  }
  result.permitted_stiffness_N_per_m =
      population_permitted_stiffness(population, result.loop, options.arms, options.seed, 0.95);
  return result;
}

StabilityMap stability_map(const AxisMargins& axis, const DemoOptions& options) {
  const auto& [nominal, timing, gains] = axis.loop;
  const double top_N_per_m = 2.5 * std::max(axis.critical_stiffness_N_per_m, gains.stiffness_N_per_m);
  const double top_Ns_per_m = std::max(8.0, 3 * gains.damping_Ns_per_m);
  StabilityMap map;
  for (std::size_t i = 0; i < kMapColumns; ++i)
    map.stiffness_N_per_m.push_back(top_N_per_m * static_cast<double>(i) / (kMapColumns - 1));
  for (std::size_t i = 0; i < kMapRows; ++i)
    map.damping_Ns_per_m.push_back(top_Ns_per_m * static_cast<double>(i) / (kMapRows - 1));
  map.stable_share.assign(kMapColumns * kMapRows, 0.0);
  map.nominal_boundary =
      trace_boundary(sample_plant(nominal, timing.sample_time_s), timing, {0, top_N_per_m, 0, top_Ns_per_m});

  const models::ArmPopulation population(axis.axis);
  const std::size_t arms = std::min(kMapArms, options.arms);
  for (std::size_t n = 0; n < arms; ++n) {
    auto plant = nominal;
    plant.arm = population.sample(options.seed, n);
    const control::ClosedLoopVerdict verdict(control::sample_plant(plant, timing.sample_time_s), timing);
    for (std::size_t i = 0; i < map.stable_share.size(); ++i) {
      const control::WallGains point{map.stiffness_N_per_m[i % kMapColumns], map.damping_Ns_per_m[i / kMapColumns]};
      if (verdict.stable(point)) map.stable_share[i] += 1 / static_cast<double>(arms);
    }
  }
  return map;
}

}  // namespace

Demo run_demo(const models::Scenario& scenario, const DemoOptions& options, const Progress& progress) {
  constexpr std::size_t kParts = 6;
  std::size_t done = 0;
  const auto advance = [&] {
    if (progress) progress(++done, kParts);
  };
  Demo demo;
  demo.scenario = scenario;
  demo.options = options;
  demo.wall = trace_loop(scenario);
  advance();
  for (const auto axis : models::kAxes) {
    demo.axes.push_back(margins_of(scenario, axis, options));
    advance();
  }
  demo.map = stability_map(demo.wall_axis(), options);
  advance();

  auto beyond = scenario;
  demo.beyond_stiffness_N_per_m = kBeyond * demo.wall_axis().critical_stiffness_N_per_m;
  beyond.loop.stiffness_N_per_m = demo.beyond_stiffness_N_per_m;
  beyond.wall.bilateral = true;
  beyond.hand.push_N = 0.2;
  beyond.run.duration_s = 4;
  demo.beyond = trace_loop(beyond);
  advance();
  return demo;
}

}  // namespace handloop::studies
