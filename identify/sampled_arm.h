#pragma once

#include <array>
#include <complex>
#include <span>
#include <vector>

#include "identify/hold.h"
#include "models/arm.h"

namespace handloop::identify {

/// Frequency response from the sampled force to the sampled position of the arm of eq. (1), exact for its hold: the
/// pulse transfer function at z = exp(j w T), or eq. (1) itself at s = j w where the force is continuous. Taking a held
/// force for a continuous one delays the model by half a sample, which a fit puts into b1.
class SampledArm {
 public:
  SampledArm(const models::ArmParameters& arm, Hold hold, double sample_time_s);

  /// m/N at the angular frequency in rad/s, below pi/T.
  std::complex<double> operator()(double frequency_rad_per_s) const;

  /// The same, and its derivatives by mass, k1, k2, b1, b2 (the order of models::kArmParameterNames).
  std::complex<double> gradient(double frequency_rad_per_s, std::array<std::complex<double>, 5>& derivative) const;

  /// Position at the samples for a force at the samples, from rest, in m. A continuous force is taken as straight
  /// lines.
  std::vector<double> simulate(std::span<const double> force_N) const;

 private:
  /// A coefficient with its derivatives by the five parameters.
  struct Coefficient {
    double value = 0;
    std::array<double, 5> by{};
  };

  models::ArmParameters arm_;
  Hold hold_;
  double sample_time_s_;
  // Grasp (g1 z + g0)/(z - e) and arm (n2 z^2 + n1 z + n0)/(z^2 + a1 z + a2); unused where the force is continuous.
  Coefficient g1_, g0_, e_, n2_, n1_, n0_, a1_, a2_;
};

}  // namespace handloop::identify
