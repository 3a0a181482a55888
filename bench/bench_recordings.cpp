#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <vector>

#include "io/csv_file.h"
#include "io/recording_file.h"

// Reading recordings from CSV files that lie in the system's cache, in bytes a second: 150 MB/s or more is wanted. Each
// round maps a file, finds its columns, reads all three and, under ReadRecording, checks them. The five ways of writing
// numbers below are the ones that recordings come in; they cost differently.
namespace {

using namespace handloop;

constexpr std::size_t kRows = 600'000;

/// How one number is written: digits after the point, significant digits, or with an exponent.
enum class Style { kFixed, kShortest, kSeventeen, kExponent, kFourDigits };

std::string written(Style style, double value) {
  switch (style) {
    case Style::kFixed: return fmt::format("{:.9f}", value);
    case Style::kShortest: return fmt::format("{}", value);
    case Style::kSeventeen: return fmt::format("{:.17g}", value);
    case Style::kExponent: return fmt::format("{:.9e}", value);
    case Style::kFourDigits: return fmt::format("{:.4g}", value);
  }
  return {};
}

/// A file of ten minutes at 1 kHz: a force of 1.25 N rms of noise through two lags, and what follows it slowly.
std::filesystem::path file_of(Style style) {
  const auto path = std::filesystem::temp_directory_path() / fmt::format("bench_{}.csv", static_cast<int>(style));
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  double force = 0, position = 0;
  std::string text = "time_s,force_N,position_m\n";
  for (std::size_t n = 0; n < kRows; ++n) {
    force += 0.15 * (4 * normal(random) - force);
    position += 0.05 * (force / 120 - position);
    text += fmt::format("{:.3f},{},{}\n", 0.001 * static_cast<double>(n), written(style, force),
                        written(style, position));
  }
  std::ofstream(path, std::ios::binary) << text;
  return path;
}

template <typename Read>
void measure(benchmark::State& state, const Read& read) {
  const auto path = file_of(static_cast<Style>(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(read(path));
  state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(std::filesystem::file_size(path)));
  std::filesystem::remove(path);
}

void ReadNumbers(benchmark::State& state) {
  measure(state, [](const auto& path) {
    const std::vector<std::size_t> all{0, 1, 2};
    return io::CsvFile(path).read_numbers(all);
  });
}

void ReadRecording(benchmark::State& state) {
  measure(state, [](const auto& path) { return io::read_recording(path, {}); });
}

void styles(benchmark::internal::Benchmark* bench) {
  bench->ArgName("fixed_shortest_17_exponent_4");
  for (int style = 0; style < 5; ++style) bench->Arg(style);
  bench->Unit(benchmark::kMillisecond);
}
BENCHMARK(ReadNumbers)->Apply(styles);
BENCHMARK(ReadRecording)->Apply(styles);

}  // namespace

BENCHMARK_MAIN();
