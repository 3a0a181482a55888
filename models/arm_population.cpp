#include "models/arm_population.h"

#include <Eigen/Cholesky>
#include <boost/math/special_functions/erf.hpp>
#include <cmath>
#include <numbers>

#include "models/errors.h"
#include "models/random.h"

namespace handloop::models {
namespace {

double normal_score(double p) {
  return -std::numbers::sqrt2 * boost::math::erfc_inv(2 * p);
}
double normal_cdf(double z) {
  return 0.5 * std::erfc(-z / std::numbers::sqrt2);
}

ArmCorrelation cholesky_factor(const ArmCorrelation& correlation) {
  if (!correlation.allFinite() || !correlation.isApprox(correlation.transpose(), 1e-9) ||
      (correlation.diagonal().array() - 1).abs().maxCoeff() > 1e-9) {
    throw InputError(
        "correlation must be a symmetric 5 x 5 matrix with ones on its diagonal, in the order M, k1, k2, b1, b2");
  }
  const Eigen::LLT<ArmCorrelation> factor(correlation);
  if (factor.info() != Eigen::Success) {
    throw InputError("correlation is not positive definite: no five parameters can be correlated like this");
  }
  return factor.matrixL();
}

}  // namespace

ArmPopulation::ArmPopulation(Axis axis, PercentileReading reading, const std::optional<ArmCorrelation>& correlation)
    : axis_(axis), reading_(reading) {
  for (std::size_t i = 0; i < kArmParameterNames.size(); ++i) {
    parameters_.emplace_back(parameter_statistics(axis, i), reading);
  }
  if (correlation) correlation_factor_ = cholesky_factor(*correlation);
}

ArmParameters ArmPopulation::sample(std::uint64_t seed, std::uint64_t index) const {
  const CounterRandom random(seed, RandomStream::arm_population, static_cast<std::uint32_t>(axis_));
  const auto first = random.uniforms(index, 0);
  std::array<double, 5> p{first[0], first[1], first[2], first[3], random.uniforms(index, 1)[0]};
  if (correlation_factor_) {
    Eigen::Matrix<double, 5, 1> score;
    for (int i = 0; i < 5; ++i) score[i] = normal_score(p[static_cast<std::size_t>(i)]);
    const Eigen::Matrix<double, 5, 1> mixed = *correlation_factor_ * score;
    for (int i = 0; i < 5; ++i) p[static_cast<std::size_t>(i)] = normal_cdf(mixed[i]);
  }
  return at_percentiles(p);
}

ArmParameters ArmPopulation::at_percentiles(const std::array<double, 5>& p) const {
  std::array<double, 5> values{};
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = parameters_[i].quantile(p[i]);
  return arm_from_array(values);
}

std::array<double, 5> ArmPopulation::percentiles(const ArmParameters& arm) const {
  const auto values = to_array(arm);
  std::array<double, 5> p{};
  for (std::size_t i = 0; i < values.size(); ++i) p[i] = parameters_[i].cdf(values[i]);
  return p;
}

}  // namespace handloop::models
