#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>

#include "models/arm_population.h"
#include "studies/progress.h"

/// Arms drawn from the population, as a file and beside the statistics they are drawn from.
namespace handloop::studies {

/// The eight statistics of one parameter over a sample, and how far they are from Table III.
struct SampledStatistics {
  models::ParameterStatistics sample;  ///< percentiles at the probabilities of the population's reading
  models::ParameterStatistics table;
  /// Largest deviation: of mean and standard deviation relative to the table, of percentiles relative to the range.
  double worst_deviation = 0.0;
  std::string worst_statistic;         ///< its name: "mean", "ci95_minimum", ...
  double distribution_distance = 0.0;  ///< models::ParameterDistribution::distance()
  bool feasible = true;                ///< models::ParameterDistribution::feasible()
  bool gap = false;  ///< only a distribution with nothing about one of the four percentiles meets the row: a sample
                     ///< then finds that percentile anywhere in the gap
};

/// In the order of kArmParameterNames.
using SampleSummary = std::array<SampledStatistics, 5>;

/// Writes arms 0 .. count-1 of the seed as CSV, `axis,mass_kg,k1_N_per_m,k2_N_per_m,b1_Ns_per_m,b2_Ns_per_m`, numbers
/// with as many digits as tell them apart. "-" is standard output. Throws InputError where the file cannot be written.
SampleSummary write_arm_sample(const models::ArmPopulation& population, std::size_t count, std::uint64_t seed,
                               const std::filesystem::path& path, const Progress& progress = {});

/// Reads a correlation matrix: five lines of five comma-separated numbers in the order M, k1, k2, b1, b2.
/// Throws InputError naming the file and what is wrong.
models::ArmCorrelation read_correlation(const std::filesystem::path& path);

/// In words: what of the population is an assumption and not published.
std::string population_assumptions(const models::ArmPopulation& population);

}  // namespace handloop::studies
