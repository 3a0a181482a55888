#pragma once

#include <cmath>
#include <numbers>

namespace handloop::models {

/// Random-input describing function of a memoryless force law f(u): the gain E[f(u) (u - mean)] / sigma^2 that leaves
/// the smallest mean-square error for Gaussian u (Gelb and Vander Velde, Multiple-Input Describing Functions, 1968, ch.
/// 1). Trapezoid over +-6 sigma: exact enough for laws with kinks, where Gauss-Hermite rules are not.
template <class ForceLaw>
double random_input_gain(ForceLaw&& f, double sigma, double mean = 0.0) {
  constexpr int kPoints = 1200;
  constexpr double kSpan = 6.0;
  double sum = 0.0;
  for (int i = 0; i <= kPoints; ++i) {
    const double u = -kSpan + 2 * kSpan * i / kPoints;
    sum += f(mean + sigma * u) * u * std::exp(-0.5 * u * u);
  }
  return sum * (2 * kSpan / kPoints) / (std::sqrt(2 * std::numbers::pi) * sigma);
}

}  // namespace handloop::models
