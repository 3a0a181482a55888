/// What the panel computes while a gain is turned.
#include <benchmark/benchmark.h>

#include "io/scenario_file.h"
#include "studies/tuning.h"

namespace {

using namespace handloop;

/// At once, in the frame: poles, margins and curve of the nominal loop.
void NominalLoop(benchmark::State& state) {
  auto scenario = io::default_scenario();
  for (auto _ : state) benchmark::DoNotOptimize(studies::tune_nominal(scenario));
}
BENCHMARK(NominalLoop)->Unit(benchmark::kMicrosecond);

/// The same with an effect: behind the window.
void NominalLoopWithAnEffect(benchmark::State& state) {
  auto scenario = io::default_scenario();
  scenario.arm.effects.emplace_back(models::Axis::z,
                                    models::make_typical_effect("reflex_feedback", models::Place::arm));
  for (auto _ : state) benchmark::DoNotOptimize(studies::tune_nominal(scenario));
}
BENCHMARK(NominalLoopWithAnEffect)->Unit(benchmark::kMillisecond);

/// Robust peaks, critical stiffness and boundary.
void RobustnessAndBoundary(benchmark::State& state) {
  const auto scenario = io::default_scenario();
  for (auto _ : state) benchmark::DoNotOptimize(studies::tune_robust(scenario));
}
BENCHMARK(RobustnessAndBoundary)->Unit(benchmark::kMillisecond);

/// Margins of 2,000 sampled arms, in one thread: CPU time is what two cores share.
void TwoThousandArms(benchmark::State& state) {
  const auto scenario = io::default_scenario();
  for (auto _ : state) benchmark::DoNotOptimize(studies::tune_population(scenario, 2000, 1, 1));
}
BENCHMARK(TwoThousandArms)->Unit(benchmark::kMillisecond);

/// The cloud of the map.
void LimitsOfTwoThousandArms(benchmark::State& state) {
  const auto scenario = io::default_scenario();
  for (auto _ : state) benchmark::DoNotOptimize(studies::population_limits(scenario, 2000, 1, {0, 3500, 0, 4}));
}
BENCHMARK(LimitsOfTwoThousandArms)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
