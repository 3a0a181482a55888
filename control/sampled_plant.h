#pragma once

#include <array>
#include <complex>

#include "control/loop.h"

namespace handloop::control {

/// A second-order factor of the sampled plant in the variable delta = z - 1: delta^2 + a1 delta + a0. Slow motion
/// sampled fast has all its poles crowded at z = 1, where polynomials in z lose every digit; in delta they keep them.
struct DeltaSection {
  double a1 = 0.0;
  double a0 = 0.0;
};

/// The exact zero-order-hold equivalent of LoopPlant at one sample time:
///
///     P(z) = (n0 + n1 delta + n2 delta^2 + n3 delta^3) / (section 1 * section 2),   delta = z - 1, in m/N
///
/// One section (a free tip) or two (tip and arm). Found from the modal form: the characteristic polynomial in s, whose
/// coefficients are sums of positive terms, is split into two real quadratics; each is sampled through its step
/// response, which is an entire function of the pole pair, so that coinciding poles, poles at zero and poles far beyond
/// the Nyquist frequency need no case of their own. Relative error about 1e-13.
struct SampledPlant {
  int section_count = 0;
  std::array<DeltaSection, 2> sections{};
  std::array<double, 4> numerator{};            ///< n0..n3, lowest power first
  std::array<std::complex<double>, 4> poles{};  ///< of P(s) in rad/s, 2 * section_count of them
  double sample_time_s = 0.0;

  /// P at delta = z - 1.
  std::complex<double> operator()(std::complex<double> delta) const;
};

/// Samples a plant. Does not check its arguments (require_valid does); allocates nothing and never throws.
SampledPlant sample_plant(const LoopPlant& plant, double sample_time_s) noexcept;

}  // namespace handloop::control
