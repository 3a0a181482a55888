#pragma once

#include <cmath>
#include <complex>

namespace handloop::control {

/// A complex number for inner loops: std::complex without the tests for infinities in every product, which cost more
/// than the product. Infinite operands give NaN; callers keep them out.
struct Cx {
  double re = 0.0;
  double im = 0.0;

  constexpr Cx() = default;
  constexpr Cx(double real, double imaginary = 0.0) : re(real), im(imaginary) {}  // a real is a complex number
  explicit Cx(std::complex<double> c) : re(c.real()), im(c.imag()) {}
  std::complex<double> std() const { return {re, im}; }

  friend constexpr Cx operator+(Cx a, Cx b) { return {a.re + b.re, a.im + b.im}; }
  friend constexpr Cx operator-(Cx a, Cx b) { return {a.re - b.re, a.im - b.im}; }
  friend constexpr Cx operator-(Cx a) { return {-a.re, -a.im}; }
  friend constexpr Cx operator*(Cx a, Cx b) { return {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re}; }
  friend constexpr Cx operator/(Cx a, Cx b) {
    const double scale = 1 / (b.re * b.re + b.im * b.im);
    return {(a.re * b.re + a.im * b.im) * scale, (a.im * b.re - a.re * b.im) * scale};
  }
  constexpr Cx conj() const { return {re, -im}; }
  constexpr double norm() const { return re * re + im * im; }  ///< squared modulus
  double abs() const { return std::sqrt(norm()); }
  double arg() const { return std::atan2(im, re); }
};

}  // namespace handloop::control
