#include "tests/support/planted_fit.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <unsupported/Eigen/MatrixFunctions>

#include "tests/support/planted_signals.h"

namespace handloop::tests {
namespace {

/// y = x of A, B driven by the force, added to `out`.
template <int n>
void add_response(const Eigen::Matrix<double, n, n>& a, const Eigen::Matrix<double, n, 1>& b, double h, bool held,
                  const std::vector<double>& force, std::vector<double>& out) {
  Eigen::Matrix<double, n + 2, n + 2> m = Eigen::Matrix<double, n + 2, n + 2>::Zero();
  m.template topLeftCorner<n, n>() = a * h;
  m.template block<n, 1>(0, n) = b * h;
  m(n, n + 1) = 1;
  const Eigen::Matrix<double, n + 2, n + 2> e = m.exp();
  const Eigen::Matrix<double, n, n> ad = e.template topLeftCorner<n, n>();
  const Eigen::Matrix<double, n, 1> step = e.template block<n, 1>(0, n), ramp = e.template block<n, 1>(0, n + 1);
  Eigen::Matrix<double, n, 1> x = Eigen::Matrix<double, n, 1>::Zero();
  for (std::size_t i = 0; i < force.size(); ++i) {
    out[i] += x(0);
    const double next = held || i + 1 == force.size() ? force[i] : force[i + 1];
    x = (ad * x + step * force[i] + ramp * (next - force[i])).eval();
  }
}

std::vector<double> response(const Eigen::VectorXd& p, const std::vector<double>& force, double h, bool held) {
  std::vector<double> y(force.size(), 0.0);
  const bool arm = p.size() == 5;
  const double mass = p(0), k = arm ? p(2) : p(2), b = arm ? p(4) : p(1);
  Eigen::Matrix2d a;
  a << 0, 1, -k / mass, -b / mass;
  add_response<2>(a, Eigen::Vector2d(0, 1 / mass), h, held, force, y);
  if (arm)
    add_response<1>(Eigen::Matrix<double, 1, 1>(-p(1) / p(3)), Eigen::Matrix<double, 1, 1>(1 / p(3)), h, held, force,
                    y);
  return y;
}

BaseFit fit(const std::vector<double>& force, const std::vector<double>& position, double h, bool held,
            const Eigen::VectorXd& guess) {
  const std::size_t from = static_cast<std::size_t>(1.0 / h), to = force.size() * 6 / 10;
  const auto rows = static_cast<Eigen::Index>(to - from);
  const std::vector<double> train(force.begin(), force.begin() + static_cast<std::ptrdiff_t>(to));
  const auto error = [&](const Eigen::VectorXd& logs) {
    const std::vector<double> y = response(logs.array().exp().matrix(), train, h, held);
    Eigen::VectorXd e(rows);
    for (Eigen::Index i = 0; i < rows; ++i) e(i) = y[from + i] - position[from + i];
    return e;
  };
  Eigen::VectorXd p = guess.array().log().matrix();
  Eigen::VectorXd e = error(p);
  double lambda = 1e-3;
  for (int iteration = 0; iteration < 25; ++iteration) {
    Eigen::MatrixXd jacobian(rows, p.size());
    for (Eigen::Index j = 0; j < p.size(); ++j) {
      Eigen::VectorXd shifted = p;
      shifted(j) += 1e-4;
      jacobian.col(j) = (error(shifted) - e) / 1e-4;
    }
    const Eigen::MatrixXd normal = jacobian.transpose() * jacobian;
    const Eigen::VectorXd gradient = jacobian.transpose() * e;
    bool better = false;
    double gain = 0;
    for (int attempt = 0; attempt < 6 && !better; ++attempt) {
      Eigen::MatrixXd damped = normal;
      damped.diagonal() *= 1 + lambda;
      damped.diagonal().array() += 1e-12 * normal.diagonal().maxCoeff();
      const Eigen::VectorXd step = damped.ldlt().solve(-gradient).cwiseMax(-1.0).cwiseMin(1.0);
      const Eigen::VectorXd candidate = (p + step)
                                            .cwiseMax(guess.array().log().matrix().array().operator-(7.0).matrix())
                                            .cwiseMin(guess.array().log().matrix().array().operator+(7.0).matrix());
      const Eigen::VectorXd candidate_error = error(candidate);
      if (candidate_error.squaredNorm() < e.squaredNorm()) {
        gain = 1 - candidate_error.squaredNorm() / e.squaredNorm();
        p = candidate;
        e = candidate_error;
        lambda = std::max(lambda / 5, 1e-9);
        better = true;
      } else {
        lambda *= 8;
      }
    }
    if (!better || gain < 1e-5) break;
  }
  BaseFit result;
  const Eigen::VectorXd values = p.array().exp().matrix();
  result.parameters.assign(values.data(), values.data() + values.size());
  result.predicted = response(values, force, h, held);
  result.held_out_rms = rms_difference(position, result.predicted, to);
  return result;
}

}  // namespace

BaseFit fit_arm(const std::vector<double>& force, const std::vector<double>& position, double sample_time_s, bool held,
                const std::array<double, 5>& guess) {
  return fit(force, position, sample_time_s, held, Eigen::Map<const Eigen::VectorXd>(guess.data(), 5));
}

BaseFit fit_axis(const std::vector<double>& force, const std::vector<double>& position, double sample_time_s, bool held,
                 const std::array<double, 3>& guess) {
  return fit(force, position, sample_time_s, held, Eigen::Map<const Eigen::VectorXd>(guess.data(), 3));
}

BaseFit fit_inverse(const std::vector<double>& force, const std::vector<double>& position, double h) {
  const auto smooth = [&](std::vector<double> v) {  // forwards and backwards: no phase
    butterworth_low_pass(v, 2, 60.0, h);
    std::reverse(v.begin(), v.end());
    butterworth_low_pass(v, 2, 60.0, h);
    std::reverse(v.begin(), v.end());
    return v;
  };
  const double start = position.front();
  std::vector<double> shifted = position;
  for (double& x : shifted) x -= start;
  const std::vector<double> x = smooth(shifted), f = smooth(force);
  const std::size_t n = x.size(), edge = static_cast<std::size_t>(0.5 / h), to = n * 6 / 10;
  Eigen::MatrixXd regressors = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(n), 3);
  for (std::size_t i = 1; i + 1 < n; ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    regressors(row, 0) = (x[i + 1] - 2 * x[i] + x[i - 1]) / (h * h);
    regressors(row, 1) = (x[i + 1] - x[i - 1]) / (2 * h);
    regressors(row, 2) = x[i] + start;
  }
  const auto first = static_cast<Eigen::Index>(edge), rows = static_cast<Eigen::Index>(to - edge);
  const Eigen::Map<const Eigen::VectorXd> target(f.data(), static_cast<Eigen::Index>(n));
  const Eigen::Vector3d p = regressors.middleRows(first, rows).colPivHouseholderQr().solve(target.segment(first, rows));
  const Eigen::VectorXd predicted = regressors * p;
  BaseFit result;
  result.parameters = {p(0), p(1), p(2)};
  result.predicted.assign(predicted.data(), predicted.data() + predicted.size());
  double sum = 0;
  for (std::size_t i = to; i < n - edge; ++i) sum += (f[i] - result.predicted[i]) * (f[i] - result.predicted[i]);
  result.held_out_rms = std::sqrt(sum / static_cast<double>(n - edge - to));
  return result;
}

}  // namespace handloop::tests
