#pragma once

#include <complex>
#include <vector>

namespace handloop::models {

/// Value of a polynomial with real coefficients, highest power first, by Horner's rule; 0 where there are none.
template <class Real>
std::complex<Real> evaluate_polynomial(const std::vector<double>& coefficients, std::complex<Real> s) {
  std::complex<Real> value = 0;
  for (const double coefficient : coefficients) value = value * s + static_cast<Real>(coefficient);
  return value;
}

}  // namespace handloop::models
