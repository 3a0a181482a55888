#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "models/arm_tables.h"

/// How much human arms differ: arms drawn from the statistics of Table III.
///
/// The table gives eight numbers a parameter and no distribution. Of all distributions through its six points (minimum,
/// four "CI" ends, maximum) that have its mean and standard deviation, the one of greatest entropy is taken: it assumes
/// least. Its density within each of the five intervals is proportional to exp(a x + b x^2) with one a and b for all.
namespace handloop::models {

/// What percentiles the printed "CI" ends are.
enum class PercentileReading {
  ecdf,  ///< the empirical distribution at p and 1 - p: 5, 33, 67 and 95 %. An inference of ours: under it the printed
         ///< means and standard deviations agree with the printed ends; they do not under the other
  central  ///< ends of the central 95 % and 67 %: 2.5, 16.5, 83.5 and 97.5 %
};

/// "ecdf" or "central". Throws InputError for anything else.
PercentileReading parse_percentile_reading(std::string_view text);
std::string_view percentile_reading_name(PercentileReading reading);
/// Probabilities of the six points minimum, 95 % low, 67 % low, 67 % high, 95 % high, maximum.
std::array<double, 6> percentile_probabilities(PercentileReading reading);

/// Distribution of one parameter. Immutable; every query is real-time safe.
class ParameterDistribution {
 public:
  /// Throws InputError unless the six points rise (equal neighbours are an atom).
  ParameterDistribution(const ParameterStatistics& statistics, PercentileReading reading);

  /// Value below which the share p of the population lies; p is clipped to [0, 1]. Monotone, exact at the six points.
  double quantile(double p) const;
  /// Share of the population at or below the value, in [0, 1].
  double cdf(double value) const;
  /// Probability per unit of the parameter; 0 outside the range. An atom has no density.
  double density(double value) const;

  double mean() const { return mean_; }
  double standard_deviation() const { return standard_deviation_; }
  const ParameterStatistics& statistics() const { return statistics_; }
  PercentileReading reading() const { return reading_; }
  /// Distance from the table: the larger of the relative errors of mean and standard deviation. Near zero unless no
  /// monotone quantile function through the six points has them: then the nearest was taken.
  double distance() const;
  /// False where the eight printed numbers cannot be met together (distance above 0.05 %).
  bool feasible() const { return distance() < 5e-4; }

 private:
  void fit();

  ParameterStatistics statistics_;
  PercentileReading reading_;
  std::vector<double> edges_;       ///< of the cells, from minimum to maximum
  std::vector<double> cumulative_;  ///< probability at each edge
  double mean_ = 0.0;
  double standard_deviation_ = 0.0;
};

/// Correlations of the five parameters' normal scores, in the order of kArmParameterNames.
using ArmCorrelation = Eigen::Matrix<double, 5, 5>;

/// The arms of one axis. Immutable: one object may serve many threads.
class ArmPopulation {
 public:
  /// Parameters independent of each other unless a correlation is given (a Gaussian copula): none was published.
  /// Throws InputError unless the correlation is symmetric, positive definite and has a unit diagonal.
  explicit ArmPopulation(Axis axis, PercentileReading reading = PercentileReading::ecdf,
                         const std::optional<ArmCorrelation>& correlation = std::nullopt);

  Axis axis() const { return axis_; }
  PercentileReading reading() const { return reading_; }
  bool correlated() const { return correlation_factor_.has_value(); }

  /// Arm number index of a seed: always the same, whatever was drawn before it and on whatever thread. Real-time safe.
  ArmParameters sample(std::uint64_t seed, std::uint64_t index) const;

  /// Arm whose parameters stand at these percentiles (0 to 1), in the order of kArmParameterNames. Real-time safe.
  ArmParameters at_percentiles(const std::array<double, 5>& p) const;
  /// Percentile (0 to 1) of each parameter. Real-time safe.
  std::array<double, 5> percentiles(const ArmParameters& arm) const;

  /// Distribution of one parameter, 0 to 4.
  const ParameterDistribution& parameter(std::size_t index) const { return parameters_.at(index); }

 private:
  Axis axis_;
  PercentileReading reading_;
  std::vector<ParameterDistribution> parameters_;
  std::optional<ArmCorrelation> correlation_factor_;  ///< lower Cholesky factor
};

}  // namespace handloop::models
