#pragma once

#include <array>
#include <span>

namespace handloop::models {

/// Grid of the `tabulated` effect: force over displacement and velocity, bilinear between knots, constant beyond them.
/// Parameters in order: centre_m, displacement_range_m, velocity_range_m_per_s, then the forces, displacement by
/// displacement, each with all velocities.
struct TabulatedGrid {
  static constexpr std::size_t kDisplacements = 11;
  static constexpr std::size_t kVelocities = 11;
  static constexpr std::size_t kFirstForce = 3;
  static constexpr std::size_t kParameters = kFirstForce + kDisplacements * kVelocities;
  /// Knots as shares of the ranges; velocities crowd about zero, where friction changes sign.
  static constexpr std::array<double, kDisplacements> kDisplacementKnots{-1, -.8, -.6, -.4, -.2, 0, .2, .4, .6, .8, 1};
  static constexpr std::array<double, kVelocities> kVelocityKnots{-1, -.5, -.2, -.07, -.02, 0, .02, .07, .2, .5, 1};

  /// Weight of each of the four knots about a point; index is that of the force among the forces.
  struct Corner {
    std::size_t index;
    double weight;
  };
  static std::array<Corner, 4> corners(double displacement_share, double velocity_share);
};

}  // namespace handloop::models
