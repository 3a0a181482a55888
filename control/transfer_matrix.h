#pragma once

#include <Eigen/Core>
#include <array>
#include <complex>
#include <vector>

/// Rational transfer functions in s and 2 x 2 matrices of them: what alpha, K and R of a force controller are.
namespace handloop::control {

/// Ratio of polynomials, highest power first.
struct TransferFunction {
  std::vector<double> numerator{0.0};
  std::vector<double> denominator{1.0};
  std::complex<double> operator()(std::complex<double> s) const;
};

TransferFunction operator*(const TransferFunction& a, const TransferFunction& b);
/// Polynomials, highest power first.
std::vector<double> multiply(const std::vector<double>& a, const std::vector<double>& b);
std::vector<double> add(const std::vector<double>& a, const std::vector<double>& b);
/// Without leading zeros; at least one coefficient stays.
std::vector<double> trimmed(std::vector<double> polynomial);

/// Rows of entries: [output][input].
struct TransferMatrix {
  std::array<std::array<TransferFunction, 2>, 2> entries;
  Eigen::Matrix2cd operator()(std::complex<double> s) const;
  bool diagonal() const;
};
TransferMatrix diagonal_matrix(const TransferFunction& first, const TransferFunction& second);

/// A proper transfer function as a recursion, by the bilinear transform without prewarping: exact at 0 Hz, frequencies
/// compressed by less than (w T)^2/12. Construction allocates; step() and reset() are real-time safe.
class DiscreteFilter {
 public:
  DiscreteFilter() = default;
  /// Throws InputError: more zeros than poles, not finite, a zero denominator, a pole in the right half plane.
  DiscreteFilter(const TransferFunction& function, double sample_time_s);
  double step(double input) noexcept;
  void reset() noexcept;

 private:
  std::vector<double> b_{0.0}, a_{1.0}, state_{0.0};  ///< in z^-1, a[0] = 1; transposed direct form II
};

}  // namespace handloop::control
