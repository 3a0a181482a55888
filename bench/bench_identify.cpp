#include <benchmark/benchmark.h>

#include <cmath>
#include <random>

#include "identify/envelope.h"
#include "identify/spectra.h"
#include "identify/unbiased_fit.h"

// The figure: spectra and fits of 135 recordings of 60,000 rows, in memory, in under 1 s on one core. Each
// benchmark below is one round over 135.
namespace {

using namespace handloop;

struct Signals {
  std::vector<double> force, position;
};

/// 135 recordings of first- plus second-order arms, advanced by small explicit steps: enough of an arm to fit.
const std::vector<Signals>& recordings() {
  static const std::vector<Signals> all = [] {
    constexpr std::size_t kCount = 135, kRows = 60000;
    std::vector<Signals> out(kCount);
    std::mt19937_64 random(1);
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> spread(0.6, 1.5);
    for (auto& r : out) {
      const double M = 0.25 * spread(random), k1 = 450 * spread(random), k2 = 110 * spread(random),
                   b1 = 3 * spread(random), b2 = 6 * spread(random);
      double f1 = 0, f2 = 0, grasp = 0, x = 0, v = 0;
      r.force.resize(kRows);
      r.position.resize(kRows);
      for (std::size_t n = 0; n < kRows; ++n) {
        f1 += 0.15 * (12 * normal(random) - f1);
        f2 += 0.15 * (f1 - f2);
        r.force[n] = f2;
        r.position[n] = std::round((grasp + x) / 3e-5) * 3e-5;
        constexpr int kSteps = 10;
        for (int s = 0; s < kSteps; ++s) {
          constexpr double h = 0.001 / kSteps;
          grasp += h * (f2 - k1 * grasp) / b1;
          v += h * (f2 - k2 * x - b2 * v) / M;
          x += h * v;
        }
      }
    }
    return out;
  }();
  return all;
}

void PaperSpectraOf135(benchmark::State& state) {
  const auto& all = recordings();
  for (auto _ : state) {
    for (const auto& r : all)
      benchmark::DoNotOptimize(identify::welch(r.force, r.position, 0.001, identify::paper_settings(0.001)));
  }
}
BENCHMARK(PaperSpectraOf135)->Unit(benchmark::kMillisecond);

void PaperMethodOn135(benchmark::State& state) {
  const auto& all = recordings();
  for (auto _ : state) {
    for (const auto& r : all) {
      const auto h =
          identify::frequency_response(identify::welch(r.force, r.position, 0.001, identify::paper_settings(0.001)));
      benchmark::DoNotOptimize(identify::fit_arm(h));
    }
  }
}
BENCHMARK(PaperMethodOn135)->Unit(benchmark::kMillisecond);

void UnbiasedMethodOn135(benchmark::State& state) {
  const auto& all = recordings();
  for (auto _ : state) {
    for (const auto& r : all) benchmark::DoNotOptimize(identify::fit_arm_unbiased(r.force, r.position, 0.001));
  }
}
BENCHMARK(UnbiasedMethodOn135)->Unit(benchmark::kMillisecond);

void OneEnvelopeOfOrderTen(benchmark::State& state) {
  std::vector<double> f, dB;
  for (int n = 1; n <= 57; ++n) {
    f.push_back(n / 1.914);
    dB.push_back(3 * std::sin(0.4 * n) - 0.1 * n);
  }
  for (auto _ : state) benchmark::DoNotOptimize(identify::fit_envelope(f, dB));
}
BENCHMARK(OneEnvelopeOfOrderTen)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
