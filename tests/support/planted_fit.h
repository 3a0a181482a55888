#pragma once

#include <array>
#include <vector>

/// The other laboratory's fit of the base models, for nothing but the error that is left without the planted effect.
namespace handloop::tests {

struct BaseFit {
  std::vector<double> parameters;  ///< arm: M, k1, k2, b1, b2; axis: M, b, k
  std::vector<double> predicted;   ///< of the output, every sample
  double held_out_rms = 0;         ///< last 40 %
};

/// Output-error fit of eq. (1) (or, without a grasp, of one mass) to the first 60 %, from a guess near the truth.
/// `held` as the force ran: exact discretisation for a held force or for one that runs straight between samples.
BaseFit fit_arm(const std::vector<double>& force, const std::vector<double>& position, double sample_time_s, bool held,
                const std::array<double, 5>& guess);
BaseFit fit_axis(const std::vector<double>& force, const std::vector<double>& position, double sample_time_s, bool held,
                 const std::array<double, 3>& guess);

/// Least squares of force = M a + b v + k x on the first 60 %; a, v by central differences of a position low-passed
/// without phase together with the force.
BaseFit fit_inverse(const std::vector<double>& force, const std::vector<double>& position, double sample_time_s);

}  // namespace handloop::tests
