#include "studies/arm_sampling.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

#include "io/csv_file.h"
#include "io/output.h"
#include "models/errors.h"

namespace handloop::studies {
namespace {

using models::kArmParameterNames;
using models::ParameterStatistics;

/// The value below which the share p of a sorted sample lies, between neighbours in proportion.
double percentile(const std::vector<double>& sorted, double p) {
  const double place = p * static_cast<double>(sorted.size() - 1);
  const auto low = static_cast<std::size_t>(place);
  const auto high = std::min(low + 1, sorted.size() - 1);
  return sorted[low] + (place - static_cast<double>(low)) * (sorted[high] - sorted[low]);
}

ParameterStatistics statistics_of(std::vector<double>& values, models::PercentileReading reading) {
  std::sort(values.begin(), values.end());
  const auto count = static_cast<double>(values.size());
  double mean = 0, square = 0;
  for (const double v : values) mean += v / count;
  for (const double v : values) square += (v - mean) * (v - mean);
  const auto p = percentile_probabilities(reading);
  return {values.front(),
          mean,
          values.back(),
          values.size() > 1 ? std::sqrt(square / (count - 1)) : 0.0,
          percentile(values, p[1]),
          percentile(values, p[4]),
          percentile(values, p[2]),
          percentile(values, p[3])};
}

void compare(SampledStatistics* result) {
  const auto& s = result->sample;
  const auto& t = result->table;
  const double range = t.maximum - t.minimum;
  const auto consider = [&](std::string_view name, double deviation) {
    if (deviation <= result->worst_deviation) return;
    result->worst_deviation = deviation;
    result->worst_statistic = name;
  };
  consider("mean", std::abs(s.mean / t.mean - 1));
  consider("standard_deviation", std::abs(s.standard_deviation / t.standard_deviation - 1));
  consider("minimum", std::abs(s.minimum - t.minimum) / range);
  consider("maximum", std::abs(s.maximum - t.maximum) / range);
  consider("ci95_minimum", std::abs(s.ci95_minimum - t.ci95_minimum) / range);
  consider("ci95_maximum", std::abs(s.ci95_maximum - t.ci95_maximum) / range);
  consider("ci67_minimum", std::abs(s.ci67_minimum - t.ci67_minimum) / range);
  consider("ci67_maximum", std::abs(s.ci67_maximum - t.ci67_maximum) / range);
}

/// True where a share of 0.2 % about one of the four percentiles spreads over more than 2 % of the range.
bool has_gap(const models::ParameterDistribution& parameter) {
  const auto& t = parameter.statistics();
  const auto p = percentile_probabilities(parameter.reading());
  return std::any_of(p.begin() + 1, p.end() - 1, [&](double at) {
    return parameter.quantile(at + 1e-3) - parameter.quantile(at - 1e-3) > 0.02 * (t.maximum - t.minimum);
  });
}

}  // namespace

SampleSummary write_arm_sample(const models::ArmPopulation& population, std::size_t count, std::uint64_t seed,
                               const std::filesystem::path& path, const Progress& progress) {
  if (count == 0) throw InputError("count = 0 leaves nothing to sample: give 1 or more arms");
  io::OutputFile file(path);
  file.write(fmt::format("axis,{}\n", fmt::join(kArmParameterNames, ",")));
  std::array<std::vector<double>, 5> columns;
  for (auto& column : columns) column.reserve(count);
  fmt::memory_buffer rows;
  constexpr std::size_t kChunk = 4096;
  for (std::size_t i = 0; i < count; ++i) {
    const auto values = to_array(population.sample(seed, i));
    fmt::format_to(std::back_inserter(rows), "{},{}\n", axis_name(population.axis()), fmt::join(values, ","));
    for (std::size_t j = 0; j < values.size(); ++j) columns[j].push_back(values[j]);
    if (rows.size() < kChunk && i + 1 < count) continue;
    file.write(std::string_view(rows.data(), rows.size()));
    rows.clear();
    if (progress) progress(i + 1, count);
  }
  file.commit();

  SampleSummary summary;
  for (std::size_t j = 0; j < summary.size(); ++j) {
    const auto& parameter = population.parameter(j);
    summary[j].sample = statistics_of(columns[j], population.reading());
    summary[j].table = parameter.statistics();
    summary[j].distribution_distance = parameter.distance();
    summary[j].feasible = parameter.feasible();
    summary[j].gap = has_gap(parameter);
    compare(&summary[j]);
  }
  return summary;
}

models::ArmCorrelation read_correlation(const std::filesystem::path& path) {
  const io::CsvFile file(path);
  if (file.columns().size() != 5) {
    throw InputError(fmt::format("{}: {} columns, but a correlation matrix has 5 (M, k1, k2, b1, b2)", file.name(),
                                 file.columns().size()));
  }
  constexpr std::array<std::size_t, 5> all{0, 1, 2, 3, 4};
  const auto columns = file.read_numbers(all);
  if (columns[0].size() != 5) {
    throw InputError(
        fmt::format("{}: {} rows, but a correlation matrix has 5 (M, k1, k2, b1, b2)", file.name(), columns[0].size()));
  }
  models::ArmCorrelation correlation;
  for (int i = 0; i < 5; ++i) {
    for (int j = 0; j < 5; ++j) correlation(i, j) = columns[static_cast<std::size_t>(j)][static_cast<std::size_t>(i)];
  }
  return correlation;
}

std::string population_assumptions(const models::ArmPopulation& population) {
  const std::string percentiles = population.reading() == models::PercentileReading::ecdf
                                      ? "the printed CI ends are read as the 5, 33, 67 and 95 % points (our inference: "
                                        "only so do they agree with the printed means and deviations)"
                                      : "the printed CI ends are read as the 2.5, 16.5, 83.5 and 97.5 % points";
  const std::string correlation = population.correlated()
                                      ? "parameters correlated as you gave it, by a Gaussian copula"
                                      : "parameters independent (their correlation was not published)";
  return percentiles + "; " + correlation;
}

}  // namespace handloop::studies
