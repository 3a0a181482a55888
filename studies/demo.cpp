#include "studies/demo.h"

#include <algorithm>
#include <boost/math/distributions/binomial.hpp>
#include <cmath>

#include "control/closed_loop_verdict.h"
#include "models/arm_population.h"
#include "models/scenario_tip.h"

namespace handloop::studies {
namespace {

/// Wall of the second run: so much stiffer than the limit.
constexpr double kBeyond = 1.2;
constexpr std::size_t kMapColumns = 61;
constexpr std::size_t kMapRows = 41;
/// Arms a point of the map: enough for steps of a quarter of a percent.
constexpr std::size_t kMapArms = 400;

control::LoopTiming timing_of(const models::Scenario& scenario) {
  return {scenario.loop.sample_time_s, scenario.loop.delay_samples, scenario.loop.cutoff_Hz};
}

control::WallGains gains_of(const models::Scenario& scenario) {
  return {scenario.loop.stiffness_N_per_m, scenario.loop.damping_Ns_per_m};
}

double fifth_percentile(std::vector<double> values) {
  const auto place = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 20);
  std::nth_element(values.begin(), place, values.end());
  return *place;
}

/// The margin that 95 % of the arms have; of an arm that is unstable nothing is left.
double fifth_percentile(const std::vector<control::Margins>& margins, double control::Margins::*which, double none) {
  std::vector<double> values;
  for (const auto& m : margins) values.push_back(m.stable ? std::abs(m.*which) : none);
  return fifth_percentile(std::move(values));
}

AxisMargins margins_of(const models::Scenario& scenario, models::Axis axis, const DemoOptions& options) {
  AxisMargins result;
  result.axis = axis;
  const auto tip = models::tip_of(scenario, axis);
  result.plant = {tip.mass_kg, tip.damping_Ns_per_m, scenario.arm.axes[static_cast<std::size_t>(axis)]};
  const auto timing = timing_of(scenario);
  const auto gains = gains_of(scenario);
  const auto nominal = control::sample_plant(result.plant, timing.sample_time_s);
  result.nominal = evaluate(nominal, timing, gains);
  result.critical_stiffness_N_per_m = critical_stiffness(nominal, timing, gains.damping_Ns_per_m);

  const models::ArmPopulation population(axis);
  std::size_t stable = 0;
  for (std::size_t i = 0; i < options.arms; ++i) {
    auto plant = result.plant;
    plant.arm = population.sample(options.seed, i);
    const auto sampled = control::sample_plant(plant, timing.sample_time_s);
    result.sampled.push_back(evaluate(sampled, timing, gains));
    result.sampled_critical_N_per_m.push_back(critical_stiffness(sampled, timing, gains.damping_Ns_per_m));
    stable += result.sampled.back().stable;
  }
  const auto count = static_cast<double>(options.arms), successes = static_cast<double>(stable);
  using Binomial = boost::math::binomial_distribution<>;
  result.stable_share = successes / count;
  result.stable_low95 = Binomial::find_lower_bound_on_p(count, successes, 0.025);
  result.stable_high95 = Binomial::find_upper_bound_on_p(count, successes, 0.025);
  result.gain_up_p05 = fifth_percentile(result.sampled, &control::Margins::gain_up, 1);
  result.phase_deg_p05 = fifth_percentile(result.sampled, &control::Margins::phase_deg, 0);
  result.disk_alpha_p05 = fifth_percentile(result.sampled, &control::Margins::disk_alpha, 0);
  result.critical_stiffness_p05_N_per_m = fifth_percentile(result.sampled_critical_N_per_m);
  return result;
}

StabilityMap stability_map(const models::Scenario& scenario, const AxisMargins& axis, const DemoOptions& options) {
  const auto timing = timing_of(scenario);
  const auto nominal = control::sample_plant(axis.plant, timing.sample_time_s);
  const double top_N_per_m = 2.5 * std::max(axis.critical_stiffness_N_per_m, scenario.loop.stiffness_N_per_m);
  const double top_Ns_per_m = std::max(8.0, 3 * scenario.loop.damping_Ns_per_m);
  StabilityMap map;
  for (std::size_t i = 0; i < kMapColumns; ++i)
    map.stiffness_N_per_m.push_back(top_N_per_m * static_cast<double>(i) / (kMapColumns - 1));
  for (std::size_t i = 0; i < kMapRows; ++i)
    map.damping_Ns_per_m.push_back(top_Ns_per_m * static_cast<double>(i) / (kMapRows - 1));
  map.stable_share.assign(kMapColumns * kMapRows, 0.0);
  map.nominal_boundary = trace_boundary(nominal, timing, {0, top_N_per_m, 0, top_Ns_per_m});

  const models::ArmPopulation population(axis.axis);
  const std::size_t arms = std::min(kMapArms, options.arms);
  for (std::size_t n = 0; n < arms; ++n) {
    auto plant = axis.plant;
    plant.arm = population.sample(options.seed, n);
    const control::ClosedLoopVerdict verdict(control::sample_plant(plant, timing.sample_time_s), timing);
    for (std::size_t i = 0; i < map.stable_share.size(); ++i) {
      const control::WallGains gains{map.stiffness_N_per_m[i % kMapColumns], map.damping_Ns_per_m[i / kMapColumns]};
      if (verdict.stable(gains)) map.stable_share[i] += 1 / static_cast<double>(arms);
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
  demo.map = stability_map(scenario, demo.wall_axis(), options);
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
