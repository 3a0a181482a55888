#include "identify/explain/discretise.h"

#include <cmath>

#include "models/matrix_exponential.h"

namespace handloop::identify {

LinearStep discretise(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b, double h_s) {
  const auto n = a.rows(), m = b.cols();
  Eigen::MatrixXd augmented = Eigen::MatrixXd::Zero(n + 2 * m, n + 2 * m);
  augmented.topLeftCorner(n, n) = a * h_s;
  augmented.block(0, n, n, m) = b * h_s;
  augmented.block(n, n + m, m, m).setIdentity();
  const Eigen::MatrixXd exponential = models::matrix_exponential(augmented);
  const Eigen::MatrixXd constant = exponential.block(0, n, n, m), ramp = exponential.block(0, n + m, n, m);
  return {exponential.topLeftCorner(n, n), constant - ramp, ramp};
}

ScalarStep discretise_decay(double rate_per_s, double gain, double h_s) {
  const double x = rate_per_s * h_s;
  const double transition = std::exp(-x);
  // integrals of exp(-rate (h - s)) ds and of the same times s/h
  const double constant = x > 1e-8 ? -std::expm1(-x) / rate_per_s : h_s;
  const double ramp = x > 1e-4 ? (1 - (-std::expm1(-x)) / x) / rate_per_s : h_s * (0.5 - x / 6);
  return {transition, gain * (constant - ramp), gain * ramp};
}

}  // namespace handloop::identify
