/// How fast the stability question is answered, on one core. One evaluation: the plant sampled anew, closed-loop poles
/// and all margins with their frequencies.
#include <benchmark/benchmark.h>

#include <vector>

#include "control/closed_loop_verdict.h"
#include "control/margins.h"

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

}  // namespace

BENCHMARK_MAIN();
