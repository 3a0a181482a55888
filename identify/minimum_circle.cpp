#include "identify/minimum_circle.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>
#include <vector>

namespace handloop::identify {

using Complex = std::complex<double>;

namespace {

/// Points this little outside (relative to the radius) count as on the circle.
constexpr double kRounding = 1e-12;

bool holds(const Circle& circle, Complex point) {
  return std::abs(point - circle.centre) <= circle.radius * (1 + kRounding);
}

Circle through(Complex a, Complex b) {
  const Complex centre = 0.5 * (a + b);
  return {centre, std::max(std::abs(a - centre), std::abs(b - centre))};
}

Circle through(Complex a, Complex b, Complex c) {
  const Complex u = b - a, v = c - a;
  const double twice_area = 2 * (u.real() * v.imag() - u.imag() * v.real());
  if (twice_area == 0) {  // on a line: the two furthest apart
    Circle best = through(a, b);
    for (const Circle& other : {through(a, c), through(b, c)}) {
      if (other.radius > best.radius) best = other;
    }
    return best;
  }
  const Complex offset = Complex(0, 1) * (v * std::norm(u) - u * std::norm(v)) / -twice_area;
  const Complex centre = a + offset;
  return {centre, std::max({std::abs(a - centre), std::abs(b - centre), std::abs(c - centre)})};
}

}  // namespace

Circle minimum_circle(std::span<const Complex> points) {
  if (points.empty()) throw std::invalid_argument("a bounding circle needs a point");
  std::vector<Complex> p(points.begin(), points.end());
  std::shuffle(p.begin(), p.end(), std::minstd_rand(1));  // any order does; a random one is fast
  Circle circle{p[0], 0.0};
  for (std::size_t i = 1; i < p.size(); ++i) {
    if (holds(circle, p[i])) continue;
    circle = {p[i], 0.0};  // p[i] is on the border of the circle of all up to i
    for (std::size_t j = 0; j < i; ++j) {
      if (holds(circle, p[j])) continue;
      circle = through(p[i], p[j]);  // and so is p[j]
      for (std::size_t k = 0; k < j; ++k) {
        if (!holds(circle, p[k])) circle = through(p[i], p[j], p[k]);
      }
    }
  }
  return circle;
}

}  // namespace handloop::identify
