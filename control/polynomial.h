#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace handloop::control {

/// A real polynomial of at most Capacity coefficients, lowest power first, on the stack.
template <std::size_t Capacity>
struct Polynomial {
  std::array<double, Capacity> c{};
  int degree = 0;

  double operator()(double x) const {
    double value = c[static_cast<std::size_t>(degree)];
    for (int i = degree; i-- > 0;) value = value * x + c[static_cast<std::size_t>(i)];
    return value;
  }

  Polynomial derivative() const {
    Polynomial d;
    d.degree = std::max(degree - 1, 0);
    for (int i = 1; i <= degree; ++i) d.c[static_cast<std::size_t>(i - 1)] = i * c[static_cast<std::size_t>(i)];
    return d;
  }

  /// Drops what lies above this power: known to be zero but for rounding.
  void truncate(int to_degree) { degree = std::min(degree, to_degree); }

  friend Polynomial operator*(const Polynomial& a, const Polynomial& b) {
    Polynomial p;
    p.degree = a.degree + b.degree;
    for (int i = 0; i <= a.degree; ++i) {
      for (int j = 0; j <= b.degree; ++j) {
        p.c[static_cast<std::size_t>(i + j)] += a.c[static_cast<std::size_t>(i)] * b.c[static_cast<std::size_t>(j)];
      }
    }
    return p;
  }
  friend Polynomial operator+(Polynomial a, const Polynomial& b) { return a.add(b, 1); }
  friend Polynomial operator-(Polynomial a, const Polynomial& b) { return a.add(b, -1); }
  friend Polynomial operator*(double s, Polynomial a) {
    for (int i = 0; i <= a.degree; ++i) a.c[static_cast<std::size_t>(i)] *= s;
    return a;
  }
  /// Times the variable.
  Polynomial shifted() const {
    Polynomial p;
    p.degree = degree + 1;
    for (int i = 0; i <= degree; ++i) p.c[static_cast<std::size_t>(i + 1)] = c[static_cast<std::size_t>(i)];
    return p;
  }

 private:
  Polynomial& add(const Polynomial& b, double sign) {
    degree = std::max(degree, b.degree);
    for (int i = 0; i <= b.degree; ++i) c[static_cast<std::size_t>(i)] += sign * b.c[static_cast<std::size_t>(i)];
    return *this;
  }
};

/// Roots found in an interval, in rising order.
template <std::size_t Capacity>
struct Roots {
  std::array<double, Capacity> x{};
  int count = 0;
  void add(double root) { x[static_cast<std::size_t>(count++)] = root; }
};

namespace detail {

/// Pascal's triangle.
inline constexpr auto kBinomial = [] {
  std::array<std::array<double, 32>, 32> t{};
  for (std::size_t i = 0; i < t.size(); ++i) {
    t[i][0] = 1;
    for (std::size_t j = 1; j <= i; ++j) t[i][j] = t[i - 1][j - 1] + (j < i ? t[i - 1][j] : 0);
  }
  return t;
}();

/// The root between a and b (0 <= a < b), where p has opposite signs. The bracket is halved by decades until it spans a
/// factor of four, then Newton's method is kept inside it. Relative precision `tolerance`.
template <std::size_t Capacity>
double bracketed_root(const Polynomial<Capacity>& p, double a, double b, double value_a, double tolerance) {
  const bool negative_left = value_a < 0;
  while (b > 4 * a && b > 1e-300) {
    const double x = std::sqrt(b * std::max(a, 1e-12 * b));
    const double value = p(x);
    if (value == 0) return x;
    ((value < 0) == negative_left ? a : b) = x;
  }
  double x = 0.5 * (a + b);
  for (int i = 0; i < 100; ++i) {
    double value = p.c[static_cast<std::size_t>(p.degree)], slope = 0;
    for (int k = p.degree; k-- > 0;) {
      slope = slope * x + value;
      value = value * x + p.c[static_cast<std::size_t>(k)];
    }
    if (value == 0) return x;
    ((value < 0) == negative_left ? a : b) = x;
    double next = x - value / slope;
    if (!(next > a && next < b) || (i > 12 && i % 2 == 0)) next = 0.5 * (a + b);
    if (std::abs(next - x) <= tolerance * std::abs(next)) return next;
    x = next;
  }
  return x;
}

}  // namespace detail

/// Every real root of p in (0, high] at which p changes sign, to a relative precision. The roots of each derivative
/// part those of the next (Yuksel, "High-Performance Polynomial Root Finding for Graphics", 2022), so that none is
/// missed that is resolved by the coefficients. Allocates nothing.
template <std::size_t Capacity>
Roots<Capacity> roots_in(const Polynomial<Capacity>& polynomial, double high, double tolerance = 1e-8) {
  Roots<Capacity> roots;
  int degree = polynomial.degree;
  while (degree > 0 && polynomial.c[static_cast<std::size_t>(degree)] == 0) --degree;
  if (degree < 1) return roots;
  // derivatives from the linear one up; p^(k)/k! has the coefficients c_i (i over k)
  static_assert(Capacity <= detail::kBinomial.size());
  Polynomial<Capacity> p;
  for (int k = degree - 1; k >= 0; --k) {
    p.degree = degree - k;
    for (int i = k; i <= degree; ++i) {
      const auto n = static_cast<std::size_t>(i);
      p.c[n - static_cast<std::size_t>(k)] = detail::kBinomial[n][static_cast<std::size_t>(k)] * polynomial.c[n];
    }
    Roots<Capacity> next;
    double a = 0, value_a = p.c[0];
    for (int i = 0; i <= roots.count; ++i) {
      const double b = i < roots.count ? roots.x[static_cast<std::size_t>(i)] : high;
      const double value_b = p(b);
      if (value_b == 0) {
        next.add(b);
      } else if (value_a != 0 && (value_a < 0) != (value_b < 0)) {
        next.add(detail::bracketed_root(p, a, b, value_a, k == 0 ? tolerance : 1e-5));
      }
      a = b, value_a = value_b;
    }
    roots = next;
  }
  return roots;
}

}  // namespace handloop::control
