#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "models/arm_population.h"
#include "models/errors.h"

namespace handloop::models {
namespace {

constexpr std::size_t kIntervals = 5;
/// Cells an interval. The density is constant within a cell: the quantile function is a polygon and exactly invertible.
constexpr std::size_t kCells = 128;

/// Edges of the cells as fractions of their interval, 0 to 1. They crowd towards both ends, where the density may be
/// steep: a row that is met only by nearly all of an interval's share at one end is still met.
double cell_edge(std::size_t c) {
  return 0.5 - 0.5 * std::cos(std::numbers::pi * static_cast<double>(c) / kCells);
}

/// Softness of the two moment conditions, in standard deviations per unit of multiplier. It bounds the multipliers
/// where the moments cannot be met and shifts them by some 1e-8 where they can.
constexpr double kSoftness = 1e-9;

/// Cells of one parameter in standard units z = (x - mean) / standard deviation of the table.
struct Cells {
  std::vector<double> centre, second_moment;  ///< means of z and z^2 within each cell
  std::vector<double> width;                  ///< as a fraction of the interval
  std::array<double, kIntervals> probability{};
};

/// Probability of each cell for the multipliers a, b: within each interval proportional to exp(a z + b z^2).
std::vector<double> cell_probabilities(const Cells& cells, const Eigen::Vector2d& multipliers, double* potential) {
  std::vector<double> share(kIntervals * kCells);
  *potential = 0;
  for (std::size_t i = 0; i < kIntervals; ++i) {
    const std::size_t first = i * kCells;
    double largest = -INFINITY;
    for (std::size_t c = first; c < first + kCells; ++c) {
      share[c] = multipliers[0] * cells.centre[c] + multipliers[1] * cells.second_moment[c];
      largest = std::max(largest, share[c]);
    }
    double sum = 0;
    for (std::size_t c = first; c < first + kCells; ++c) {
      share[c] = cells.width[c] * std::exp(share[c] - largest);
      sum += share[c];
    }
    for (std::size_t c = first; c < first + kCells; ++c) share[c] *= cells.probability[i] / sum;
    *potential += cells.probability[i] * (largest + std::log(sum));
  }
  return share;
}

/// Mean and mean square of z, and their derivatives by the multipliers: the covariance within the intervals.
void moments(const Cells& cells, const std::vector<double>& share, Eigen::Vector2d* value,
             Eigen::Matrix2d* derivative) {
  value->setZero();
  derivative->setZero();
  for (std::size_t i = 0; i < kIntervals; ++i) {
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    Eigen::Matrix2d square = Eigen::Matrix2d::Zero();
    for (std::size_t c = i * kCells; c < (i + 1) * kCells; ++c) {
      const Eigen::Vector2d z(cells.centre[c], cells.second_moment[c]);
      sum += share[c] * z;
      square += share[c] * z * z.transpose();
    }
    *value += sum;
    *derivative += square - sum * sum.transpose() / cells.probability[i];
  }
}

/// Multipliers of greatest entropy: the minimum of a convex potential (Newton's method with a line search).
std::vector<double> solve(const Cells& cells) {
  const Eigen::Vector2d target(0, 1);
  const auto cost = [&](const Eigen::Vector2d& m, double potential) {
    return potential - target.dot(m) + 0.5 * kSoftness * m.squaredNorm();
  };
  Eigen::Vector2d multipliers = Eigen::Vector2d::Zero();
  double potential = 0;
  auto share = cell_probabilities(cells, multipliers, &potential);
  for (int iteration = 0; iteration < 200; ++iteration) {
    Eigen::Vector2d value;
    Eigen::Matrix2d derivative;
    moments(cells, share, &value, &derivative);
    const Eigen::Vector2d slope = value - target + kSoftness * multipliers;
    if (slope.norm() < 1e-13) break;
    derivative += kSoftness * Eigen::Matrix2d::Identity();
    const Eigen::Vector2d step = -derivative.ldlt().solve(slope);
    const double before = cost(multipliers, potential);
    double length = 1;
    for (; length > 1e-12; length /= 2) {
      double trial = 0;
      auto tried = cell_probabilities(cells, multipliers + length * step, &trial);
      if (cost(multipliers + length * step, trial) <= before + 1e-4 * length * slope.dot(step)) {
        multipliers += length * step;
        share = std::move(tried);
        potential = trial;
        break;
      }
    }
    if (length <= 1e-12) break;
  }
  return share;
}

}  // namespace

PercentileReading parse_percentile_reading(std::string_view text) {
  if (text == "ecdf") return PercentileReading::ecdf;
  if (text == "central") return PercentileReading::central;
  throw InputError("unknown reading of the percentiles '" + std::string(text) +
                   "': give ecdf (5, 33, 67, 95 %) or central (2.5, 16.5, 83.5, 97.5 %)");
}

std::string_view percentile_reading_name(PercentileReading reading) {
  return reading == PercentileReading::ecdf ? "ecdf" : "central";
}

std::array<double, 6> percentile_probabilities(PercentileReading reading) {
  if (reading == PercentileReading::ecdf) return {0, 0.05, 0.33, 0.67, 0.95, 1};
  return {0, 0.025, 0.165, 0.835, 0.975, 1};
}

ParameterDistribution::ParameterDistribution(const ParameterStatistics& statistics, PercentileReading reading)
    : statistics_(statistics), reading_(reading) {
  fit();
}

void ParameterDistribution::fit() {
  const auto& t = statistics_;
  const std::array<double, 6> points{t.minimum,      t.ci95_minimum, t.ci67_minimum,
                                     t.ci67_maximum, t.ci95_maximum, t.maximum};
  const auto probabilities = percentile_probabilities(reading_);
  if (!std::is_sorted(points.begin(), points.end()) || !(points.front() < points.back()) ||
      !(t.standard_deviation > 0)) {
    throw InputError("statistics of a parameter must rise from minimum over the four percentiles to maximum");
  }
  Cells cells;
  edges_.push_back(points[0]);
  for (std::size_t i = 0; i < kIntervals; ++i) {
    cells.probability[i] = probabilities[i + 1] - probabilities[i];
    for (std::size_t c = 0; c < kCells; ++c) {
      const double low = edges_.back();
      const double high = c + 1 == kCells ? points[i + 1] : points[i] + (points[i + 1] - points[i]) * cell_edge(c + 1);
      cells.width.push_back(cell_edge(c + 1) - cell_edge(c));
      const double a = (low - t.mean) / t.standard_deviation;
      const double b = (high - t.mean) / t.standard_deviation;
      cells.centre.push_back((a + b) / 2);
      cells.second_moment.push_back((a * a + a * b + b * b) / 3);
      edges_.push_back(high);
    }
  }
  const auto share = solve(cells);

  cumulative_.push_back(0);
  for (std::size_t i = 0; i < kIntervals; ++i) {
    double sum = probabilities[i];
    for (std::size_t c = 0; c < kCells; ++c) {
      sum += share[i * kCells + c];
      // The ends of the intervals are exact, so that the quantile function passes through the printed points.
      cumulative_.push_back(c + 1 == kCells ? probabilities[i + 1] : std::min(sum, probabilities[i + 1]));
    }
  }
  Eigen::Vector2d value;
  Eigen::Matrix2d derivative;
  moments(cells, share, &value, &derivative);
  mean_ = t.mean + t.standard_deviation * value[0];
  standard_deviation_ = t.standard_deviation * std::sqrt(value[1] - value[0] * value[0]);
}

double ParameterDistribution::quantile(double p) const {
  if (!(p > 0)) return edges_.front();
  if (p >= 1) return edges_.back();
  const auto above = std::upper_bound(cumulative_.begin(), cumulative_.end(), p);
  const auto cell = static_cast<std::size_t>(above - cumulative_.begin()) - 1;
  const double fraction = (p - cumulative_[cell]) / (cumulative_[cell + 1] - cumulative_[cell]);
  return edges_[cell] + fraction * (edges_[cell + 1] - edges_[cell]);
}

double ParameterDistribution::cdf(double value) const {
  if (!(value >= edges_.front())) return 0;
  if (value >= edges_.back()) return 1;
  const auto above = std::upper_bound(edges_.begin(), edges_.end(), value);
  const auto cell = static_cast<std::size_t>(above - edges_.begin()) - 1;
  const double fraction = (value - edges_[cell]) / (edges_[cell + 1] - edges_[cell]);
  return cumulative_[cell] + fraction * (cumulative_[cell + 1] - cumulative_[cell]);
}

double ParameterDistribution::density(double value) const {
  if (!(value >= edges_.front()) || value >= edges_.back()) return 0;
  const auto above = std::upper_bound(edges_.begin(), edges_.end(), value);
  const auto cell = static_cast<std::size_t>(above - edges_.begin()) - 1;
  return (cumulative_[cell + 1] - cumulative_[cell]) / (edges_[cell + 1] - edges_[cell]);
}

double ParameterDistribution::distance() const {
  return std::max(std::abs(mean_ / statistics_.mean - 1),
                  std::abs(standard_deviation_ / statistics_.standard_deviation - 1));
}

}  // namespace handloop::models
