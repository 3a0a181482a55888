#include "sim/exponential_step.h"

#include <array>
#include <cmath>
#include <stdexcept>

#include "models/matrix_exponential.h"

namespace handloop::sim {
namespace {

using Eigen::Matrix2d;

/// e^A, phi_1(A), phi_2(A), phi_3(A), read off one exponential of the matrix [A I 0 0; 0 0 I 0; 0 0 0 I; 0 0 0 0]
/// (Al-Mohy and Higham, SIAM J. Sci. Comput. 33 (2011) 488, theorem 2.1).
std::array<Matrix2d, 4> phi_functions(const Matrix2d& a) {
  Eigen::Matrix<double, 8, 8> augmented = Eigen::Matrix<double, 8, 8>::Zero();
  augmented.topLeftCorner<2, 2>() = a;
  for (int block = 0; block < 3; ++block) augmented.block<2, 2>(2 * block, 2 * block + 2).setIdentity();
  const Eigen::Matrix<double, 8, 8> exponential = models::matrix_exponential(augmented);
  std::array<Matrix2d, 4> phi;
  for (int i = 0; i < 4; ++i) phi[i] = exponential.block<2, 2>(0, 2 * i);
  return phi;
}

}  // namespace

ExponentialStep::ExponentialStep(const Matrix2d& linear, double step_s) : linear_(linear) {
  // positions in units in which they are as large as velocities: the exponential of a stiff arm stays well scaled
  const double scale = std::max(1.0, std::sqrt(std::abs(linear(1, 0))));
  Matrix2d scaled = linear;
  scaled(0, 1) *= scale;
  scaled(1, 0) /= scale;
  const auto unscale = [scale](Matrix2d matrix) {
    matrix(0, 1) /= scale;
    matrix(1, 0) *= scale;
    return matrix;
  };
  const double h = step_s;
  const auto at_half = phi_functions(scaled * (0.5 * h));
  const auto at_whole = phi_functions(scaled * h);
  half_ = unscale(at_half[0]);
  half_input_ = unscale(0.5 * h * at_half[1]);
  whole_ = unscale(at_whole[0]);
  first_ = unscale(h * (at_whole[1] - 3 * at_whole[2] + 4 * at_whole[3]));
  middle_ = unscale(h * 2 * (at_whole[2] - 2 * at_whole[3]));
  last_ = unscale(h * (4 * at_whole[3] - at_whole[2]));
  if (!whole_.allFinite() || !first_.allFinite())
    throw std::invalid_argument("the linear part of the arm is not finite");
}

Eigen::Vector2d ExponentialStep::stage(int index, const Eigen::Vector2d& y, const Eigen::Vector2d (&n)[4]) const {
  switch (index) {
    case 0:
      return y;
    case 1:
      return half_ * y + half_input_ * n[0];
    case 2:
      return half_ * y + half_input_ * n[1];
    case 3:
      return half_ * (half_ * y + half_input_ * n[0]) + half_input_ * (2 * n[2] - n[0]);
    default:
      return whole_ * y + first_ * n[0] + middle_ * (n[1] + n[2]) + last_ * n[3];
  }
}

}  // namespace handloop::sim
