#pragma once

#include <complex>
#include <span>

namespace handloop::identify {

struct Circle {
  std::complex<double> centre{0};
  double radius = 0.0;
};

/// The smallest circle that holds every point: exact (Welzl's algorithm, expected linear time), the same for any order
/// of the points up to rounding. A circle of radius 0 for one point. Throws std::invalid_argument for none.
Circle minimum_circle(std::span<const std::complex<double>> points);

}  // namespace handloop::identify
