#include "control/multi_axis.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "control/loop_function.h"
#include "control/scan.h"
#include "control/structured_singular_value.h"
#include "models/errors.h"
#include "models/matrix_exponential.h"

namespace handloop::control {
namespace {

using Complex = std::complex<double>;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;

/// Three tip positions, then those of the arms; then the velocities, per sample.
struct Sampled {
  MatrixXd phi, gamma, output;
};

Sampled sample(const MultiAxisPlant& plant, double T) {
  std::vector<int> held;
  for (int i = 0; i < 3; ++i) {
    if (plant.arms[static_cast<std::size_t>(i)]) held.push_back(i);
  }
  const auto n = static_cast<Eigen::Index>(3 + held.size());
  MatrixXd mass = MatrixXd::Zero(n, n), damping = mass, stiffness = mass;
  mass.topLeftCorner(3, 3) = plant.tip_inertia_kg;
  damping.topLeftCorner(3, 3) = plant.tip_damping_Ns_per_m;
  for (std::size_t k = 0; k < held.size(); ++k) {
    const auto& arm = *plant.arms[static_cast<std::size_t>(held[k])];
    const Eigen::Index tip = held[k], hand = 3 + static_cast<Eigen::Index>(k);
    Eigen::VectorXd grasp = Eigen::VectorXd::Zero(n);
    grasp(tip) = 1, grasp(hand) = -1;
    stiffness += arm.k1_N_per_m * grasp * grasp.transpose();
    damping += arm.b1_Ns_per_m * grasp * grasp.transpose();
    stiffness(hand, hand) += arm.k2_N_per_m;
    damping(hand, hand) += arm.b2_Ns_per_m;
    mass(hand, hand) += arm.mass_kg;
  }
  const Eigen::PartialPivLU<MatrixXd> inertia(mass);
  MatrixXd A = MatrixXd::Zero(2 * n + 3, 2 * n + 3);
  A.block(0, n, n, n).setIdentity();
  A.block(n, 0, n, n) = -T * T * inertia.solve(stiffness);
  A.block(n, n, n, n) = -T * inertia.solve(damping);
  MatrixXd push = MatrixXd::Zero(n, 3);
  push.topRows(3).setIdentity();
  A.block(n, 2 * n, n, 3) = T * T * inertia.solve(push);
  const MatrixXd e = models::matrix_exponential(A);
  Sampled s;
  s.phi = e.topLeftCorner(2 * n, 2 * n);
  s.gamma = e.topRightCorner(2 * n, 3);
  s.output = MatrixXd::Zero(3, 2 * n);
  s.output.leftCols(3).setIdentity();
  return s;
}

/// The walls: C_i = K_i + B_i (1-a)/T delta/(delta + 1 - a).
struct Walls {
  std::array<WallGains, 3> gains;
  double one_minus_a, T;
  Complex at(int axis, Complex delta) const {
    const auto& g = gains[static_cast<std::size_t>(axis)];
    return g.stiffness_N_per_m + g.damping_Ns_per_m * one_minus_a / T * delta / (delta + one_minus_a);
  }
};

Eigen::VectorXcd closed_poles(const Sampled& s, const Walls& walls, int delay) {
  const Eigen::Index n = s.phi.rows(), size = n + 3 + 3 * delay;
  MatrixXd M = MatrixXd::Zero(size, size);
  MatrixXd u = MatrixXd::Zero(3, size);  // newest forces as rows over the states
  for (int i = 0; i < 3; ++i) {
    const auto& g = walls.gains[static_cast<std::size_t>(i)];
    const double slope = g.damping_Ns_per_m * walls.one_minus_a / walls.T;
    u.row(i).head(n) = -(g.stiffness_N_per_m + slope) * s.output.row(i);
    u(i, n + i) = -1;
    M.row(n + i).head(n) = -slope * walls.one_minus_a * s.output.row(i);
    M(n + i, n + i) = 1 - walls.one_minus_a;
  }
  M.topLeftCorner(n, n) = s.phi;
  if (delay == 0) {
    M.topRows(n) += s.gamma * u;
  } else {
    M.middleRows(n + 3, 3) = u;
    for (int k = 1; k < delay; ++k) M.block(n + 3 + 3 * k, n + 3 * k, 3, 3).setIdentity();
    M.block(0, n + 3 * delay, n, 3) += s.gamma;
  }
  return Eigen::EigenSolver<MatrixXd>(M, false).eigenvalues();
}

std::string name_direction(const Eigen::Vector3d& v) {
  static const std::array<const char*, 3> kNames{"x (left-right)", "y (up-down)", "z (forward-backward)"};
  std::string name;
  for (int i = 0; i < 3; ++i) {
    if (v(i) < 0.3) continue;
    name += (name.empty() ? "" : " and ") + std::string(kNames[static_cast<std::size_t>(i)]);
  }
  return name;
}

}  // namespace

MultiAxisMargins evaluate(const MultiAxisPlant& plant, const LoopTiming& timing,
                          const std::array<WallGains, 3>& gains) {
  require_valid(timing);
  if (Eigen::LLT<Eigen::Matrix3d>(plant.tip_inertia_kg).info() != Eigen::Success) {
    throw InputError("tip inertia: must be symmetric and positive definite");
  }
  const double T = timing.sample_time_s;
  const Sampled s = sample(plant, T);
  const Walls walls{gains, -std::expm1(-2 * std::numbers::pi * timing.cutoff_Hz * T), T};
  MultiAxisMargins result;
  const auto poles = closed_poles(s, walls, timing.delay_samples);
  result.rho = poles.cwiseAbs().maxCoeff();
  result.stable = result.rho < 1;
  if (!result.stable) return result;

  std::vector<int> active;
  for (int i = 0; i < 3; ++i) {
    const auto& g = gains[static_cast<std::size_t>(i)];
    if (g.stiffness_N_per_m != 0 || g.damping_Ns_per_m != 0) active.push_back(i);
  }
  if (active.empty()) {
    result.disk_alpha = 2;
    return result;
  }
  const auto m = static_cast<Eigen::Index>(active.size());
  const auto S_minus_T = [&](double w) {
    const Complex delta = LoopFunction::delta_at(w * T).std();
    const Eigen::Index n = s.phi.rows();
    const MatrixXcd response =
        s.output.cast<Complex>() * (MatrixXcd::Identity(n, n) * (1.0 + delta) - s.phi.cast<Complex>())
                                       .partialPivLu()
                                       .solve(s.gamma.cast<Complex>());
    MatrixXcd L(m, m);
    for (Eigen::Index i = 0; i < m; ++i) {
      for (Eigen::Index j = 0; j < m; ++j) {
        L(i, j) = response(active[static_cast<std::size_t>(i)], active[static_cast<std::size_t>(j)]) *
                  walls.at(active[static_cast<std::size_t>(j)], delta) * std::pow(1.0 + delta, -timing.delay_samples);
      }
    }
    const MatrixXcd identity = MatrixXcd::Identity(m, m);
    return MatrixXcd((identity + L).partialPivLu().solve(identity - L));
  };
  const std::vector<UncertaintyBlock> blocks(static_cast<std::size_t>(m));
  const auto mu_at = [&](double w) { return mu_upper_bound(S_minus_T(w), blocks); };

  // the largest singular value bounds mu: only where it is high is mu computed
  const double nyquist = std::numbers::pi / T;
  FrequencyGrid grid(1e-4 * nyquist, nyquist * (1 - 1e-9));
  grid.add_logarithmic(40);
  grid.add_even(40);
  for (const Complex z : poles) {
    if (std::abs(z) > 0.5 && z.imag() > 0) {
      const double width = std::max(1 - std::abs(z), 1e-9) / T, w = std::arg(z) / T;
      for (const double k : {-1.0, -0.5, 0.0, 0.5, 1.0}) grid.add(w + k * width);
    }
  }
  const auto points = grid.sorted();
  std::vector<double> bound(points.size()), mu(points.size(), 0.0);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const MatrixXcd M = S_minus_T(points[i]);
    bound[i] = Eigen::JacobiSVD<MatrixXcd>(M).singularValues()(0);
    for (Eigen::Index k = 0; k < m; ++k) {
      auto& alone = result.one_at_a_time[static_cast<std::size_t>(active[static_cast<std::size_t>(k)])];
      const double alpha = 2 / std::abs(M(k, k));
      if (std::isnan(alone) || alpha < alone) alone = alpha;
    }
  }
  std::vector<std::size_t> order(points.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(), [&](auto a, auto b) { return bound[a] > bound[b]; });
  double peak = 0, at = points[0];
  for (const std::size_t i : order) {
    if (bound[i] <= peak) break;
    const double value = mu_at(points[i]).value;
    if (value > peak) peak = value, at = points[i];
  }
  const auto here = static_cast<std::size_t>(std::lower_bound(points.begin(), points.end(), at) - points.begin());
  const double left = points[here > 0 ? here - 1 : 0], right = points[std::min(here + 1, points.size() - 1)];
  std::uintmax_t most = 40;
  const auto [w, value] =
      boost::math::tools::brent_find_minima([&](double x) { return -mu_at(x).value; }, left, right, 24, most);
  if (-value > peak) peak = -value, at = w;
  result.disk_alpha = 2 / peak;
  result.disk_at_rad_per_s = at;
  const auto worst = mu_at(at);
  const MatrixXcd M = S_minus_T(at);
  const MatrixXcd scaled =
      worst.scaling.cast<Complex>().asDiagonal() * M * worst.scaling.cwiseInverse().cast<Complex>().asDiagonal();
  const Eigen::JacobiSVD<MatrixXcd> svd(scaled, Eigen::ComputeThinU | Eigen::ComputeThinV);
  // the motion that rings: out of the perturbed loops, in units of the tip
  const Eigen::VectorXcd v = worst.scaling.cwiseInverse().cast<Complex>().asDiagonal() * svd.matrixU().col(0);
  for (Eigen::Index k = 0; k < m; ++k) result.worst_direction(active[static_cast<std::size_t>(k)]) = std::abs(v(k));
  if (result.worst_direction.norm() > 0) result.worst_direction.normalize();
  result.worst_direction_name = name_direction(result.worst_direction);
  return result;
}

}  // namespace handloop::control
