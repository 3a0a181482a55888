#include "control/transfer_matrix.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "control/transfer_loop.h"
#include "models/errors.h"
#include "models/polynomial.h"

namespace handloop::control {
namespace {

/// (c (z - 1))^power (z + 1)^(order - power), highest power of z first.
std::vector<double> bilinear_term(std::size_t power, std::size_t order, double c) {
  std::vector<double> p{1.0};
  for (std::size_t i = 0; i < order; ++i) p = multiply(p, i < power ? std::vector{c, -c} : std::vector{1.0, 1.0});
  return p;
}

std::vector<double> bilinear(const std::vector<double>& p, std::size_t order, double c) {
  std::vector<double> result(order + 1, 0.0);
  for (std::size_t i = 0; i < p.size(); ++i) {
    const auto term = bilinear_term(p.size() - 1 - i, order, c);
    for (std::size_t k = 0; k < term.size(); ++k) result[k] += p[i] * term[k];
  }
  return result;
}

bool finite(const std::vector<double>& p) {
  return std::all_of(p.begin(), p.end(), [](double value) { return std::isfinite(value); });
}

}  // namespace

std::complex<double> TransferFunction::operator()(std::complex<double> s) const {
  return models::evaluate_polynomial(numerator, s) / models::evaluate_polynomial(denominator, s);
}

std::vector<double> multiply(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> p(a.size() + b.size() - 1, 0.0);
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t k = 0; k < b.size(); ++k) p[i + k] += a[i] * b[k];
  }
  return p;
}

std::vector<double> add(const std::vector<double>& a, const std::vector<double>& b) {
  const auto& longer = a.size() >= b.size() ? a : b;
  const auto& shorter = a.size() >= b.size() ? b : a;
  std::vector<double> sum = longer;
  for (std::size_t i = 0; i < shorter.size(); ++i) sum[sum.size() - shorter.size() + i] += shorter[i];
  return sum;
}

std::vector<double> trimmed(std::vector<double> polynomial) {
  const auto first = std::find_if(polynomial.begin(), polynomial.end(), [](double c) { return c != 0.0; });
  polynomial.erase(polynomial.begin(), first);
  if (polynomial.empty()) polynomial.push_back(0.0);
  return polynomial;
}

TransferFunction operator*(const TransferFunction& a, const TransferFunction& b) {
  return {trimmed(multiply(a.numerator, b.numerator)), trimmed(multiply(a.denominator, b.denominator))};
}

Eigen::Matrix2cd TransferMatrix::operator()(std::complex<double> s) const {
  Eigen::Matrix2cd value;
  for (std::size_t i = 0; i < 2; ++i) {
    for (std::size_t k = 0; k < 2; ++k) {
      value(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) = entries[i][k](s);
    }
  }
  return value;
}

bool TransferMatrix::diagonal() const {
  return trimmed(entries[0][1].numerator) == std::vector{0.0} && trimmed(entries[1][0].numerator) == std::vector{0.0};
}

TransferMatrix diagonal_matrix(const TransferFunction& first, const TransferFunction& second) {
  TransferMatrix matrix;
  matrix.entries[0][0] = first;
  matrix.entries[1][1] = second;
  return matrix;
}

DiscreteFilter::DiscreteFilter(const TransferFunction& function, double sample_time_s) {
  const auto numerator = trimmed(function.numerator), denominator = trimmed(function.denominator);
  if (!finite(numerator) || !finite(denominator) || denominator == std::vector{0.0}) {
    throw InputError("a transfer function needs finite coefficients and a denominator that is not zero");
  }
  if (numerator.size() > denominator.size()) {
    throw InputError("a filter with more zeros (" + std::to_string(numerator.size() - 1) + ") than poles (" +
                     std::to_string(denominator.size() - 1) + ") cannot run: it would need samples of the future");
  }
  for (const auto& pole : polynomial_roots(denominator)) {
    if (pole.real() > 0.0) throw InputError("a filter with a pole in the right half plane cannot run: it is unstable");
  }
  const std::size_t order = denominator.size() - 1;
  const double c = 2.0 / sample_time_s;
  a_ = bilinear(denominator, order, c);
  b_ = bilinear(numerator, order, c);
  const double lead = a_[0];
  for (auto& value : a_) value /= lead;
  for (auto& value : b_) value /= lead;
  state_.assign(order + 1, 0.0);
}

double DiscreteFilter::step(double input) noexcept {
  const std::size_t order = a_.size() - 1;
  const double output = b_[0] * input + state_[0];
  for (std::size_t i = 0; i < order; ++i) {
    state_[i] = (i + 1 < order ? state_[i + 1] : 0.0) + b_[i + 1] * input - a_[i + 1] * output;
  }
  return output;
}

void DiscreteFilter::reset() noexcept {
  std::fill(state_.begin(), state_.end(), 0.0);
}

}  // namespace handloop::control
