/// How fast the stability question is answered, on one core. One evaluation: the plant sampled anew, closed-loop poles
/// and all margins with their frequencies.
#include <benchmark/benchmark.h>

#include <string>
#include <vector>

#include "control/arm_box.h"
#include "control/closed_loop_verdict.h"
#include "control/margins.h"
#include "control/population_margins.h"
#include "studies/margins_cases.h"

namespace {

using namespace handloop;

/// Loops like those of the arm population: Table II's ranges widened, gains over the useful plane. About half are
/// stable.
std::vector<control::Loop> loops(std::size_t count, bool only_stable) {
  std::vector<control::Loop> result;
  unsigned long state = 12345;
  const auto uniform = [&state](double low, double high) {
    state = state * 6364136223846793005UL + 1442695040888963407UL;
    return low + (high - low) * static_cast<double>(state >> 11) / 9007199254740992.0;
  };
  while (result.size() < count) {
    control::Loop loop;
    loop.plant.arm = models::ArmParameters{uniform(0.05, 0.7), uniform(200, 1500), uniform(30, 400), uniform(0.1, 8),
                                           uniform(1, 20)};
    loop.gains = {uniform(50, 5000), uniform(0, 10)};
    if (only_stable && !control::evaluate(loop).stable) continue;
    result.push_back(loop);
  }
  return result;
}

void FullEvaluation(benchmark::State& state) {
  const auto cases = loops(4096, true);
  std::size_t i = 0;
  for (auto _ : state) benchmark::DoNotOptimize(control::evaluate(cases[i++ & 4095]));
  state.SetItemsProcessed(state.iterations());
}
BENCHMARK(FullEvaluation);

void PolesOnly(benchmark::State& state) {
  const auto cases = loops(4096, true);
  std::size_t i = 0;
  for (auto _ : state) {
    const auto& loop = cases[i++ & 4095];
    benchmark::DoNotOptimize(
        control::closed_loop_poles(control::sample_plant(loop.plant, 1e-3), loop.timing, loop.gains).rho());
  }
  state.SetItemsProcessed(state.iterations());
}
BENCHMARK(PolesOnly);

void SamplingThePlant(benchmark::State& state) {
  const auto cases = loops(4096, true);
  std::size_t i = 0;
  for (auto _ : state) benchmark::DoNotOptimize(control::sample_plant(cases[i++ & 4095].plant, 1e-3));
  state.SetItemsProcessed(state.iterations());
}
BENCHMARK(SamplingThePlant);

void VerdictForOnePlantAndManyGains(benchmark::State& state) {
  const auto cases = loops(4096, false);
  const control::ClosedLoopVerdict verdict(control::sample_plant(cases[0].plant, 1e-3), control::LoopTiming{});
  std::size_t i = 0;
  for (auto _ : state) benchmark::DoNotOptimize(verdict.stable(cases[i++ & 4095].gains));
  state.SetItemsProcessed(state.iterations());
}
BENCHMARK(VerdictForOnePlantAndManyGains);

void PopulationOfTwoThousandArms(benchmark::State& state) {
  const models::ArmPopulation population(models::Axis::z);
  const control::Loop loop{{0.084, 0.017, {}}, {}, {400, 1}};
  for (auto _ : state) benchmark::DoNotOptimize(control::population_margins(population, loop, 2000, 1));
}
BENCHMARK(PopulationOfTwoThousandArms)->Unit(benchmark::kMillisecond)->UseRealTime();

void ProofForEveryArmOfABox(benchmark::State& state) {
  const auto box = control::published_box(models::Axis::z, control::BoxSet::percent95);
  for (auto _ : state) benchmark::DoNotOptimize(control::certify({0.084, 0.017, {}}, {}, {400, 1}, box));
}
BENCHMARK(ProofForEveryArmOfABox)->Unit(benchmark::kMillisecond);

/// `margins --cases` without the disk: text in, text out, all cores.
void CasesFromTextToText(benchmark::State& state) {
  std::string csv = "id,axis,M,k1,k2,b1,b2,K,B\n";
  std::size_t id = 0;
  for (const auto& loop : loops(20000, false)) {
    const auto arm = models::to_array(*loop.plant.arm);
    csv += std::to_string(id++) + ",X";
    for (const double value : arm) csv += "," + std::to_string(value);
    csv +=
        "," + std::to_string(loop.gains.stiffness_N_per_m) + "," + std::to_string(loop.gains.damping_Ns_per_m) + "\n";
  }
  for (auto _ : state) benchmark::DoNotOptimize(studies::margins_of_cases(csv, "cases.csv"));
  state.SetItemsProcessed(state.iterations() * 20000);
}
BENCHMARK(CasesFromTextToText)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace

BENCHMARK_MAIN();
