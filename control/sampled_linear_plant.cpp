#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "control/linear_plant.h"
#include "control/loop_function.h"
#include "control/margin_collector.h"
#include "control/scan.h"
#include "models/matrix_exponential.h"

namespace handloop::control {
namespace {

using Complex = std::complex<double>;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// exp(A t) and its integral from 0 to t applied to B.
std::pair<MatrixXd, VectorXd> hold(const MatrixXd& A, const VectorXd& B, double t) {
  const Eigen::Index n = A.rows();
  MatrixXd both = MatrixXd::Zero(n + 1, n + 1);
  both.topLeftCorner(n, n) = A * t;
  both.topRightCorner(n, 1) = B * t;
  const MatrixXd e = models::matrix_exponential(both);
  return {e.topLeftCorner(n, n), e.topRightCorner(n, 1)};
}

}  // namespace

SampledLinearPlant::SampledLinearPlant(const LinearPlant& plant, double sample_time_s) : sample_time_s_(sample_time_s) {
  const double T = sample_time_s;
  // measured in samples, displacements and velocities are of one size, which keeps the eigenvalues' digits
  const Eigen::Index n = plant.A.rows();
  VectorXd scale(n);
  MatrixXd A = plant.A * T;
  VectorXd B = plant.B * T;
  Eigen::RowVectorXd C = plant.C;
  scale.setOnes();
  for (int sweep = 0; sweep < 20; ++sweep) {  // Osborne's balancing, by powers of two: no rounding
    for (Eigen::Index i = 0; i < n; ++i) {
      const double row = A.row(i).cwiseAbs().sum() - std::abs(A(i, i)),
                   column = A.col(i).cwiseAbs().sum() - std::abs(A(i, i));
      if (row == 0 || column == 0) continue;
      const double factor = std::exp2(std::round(0.5 * std::log2(row / column)));
      A.row(i) /= factor, A.col(i) *= factor;
      B(i) /= factor, C(i) *= factor;
    }
  }
  const double samples = plant.delay_s / T;
  whole_delay_ = static_cast<int>(std::floor(samples + 1e-9));
  const double rest = std::max(0.0, samples - whole_delay_);
  const auto [phi, gamma] = hold(A, B, 1.0);
  phi_ = phi;
  if (rest > 1e-9) {
    const auto late = hold(A, B, 1 - rest), early = hold(A, B, rest);
    gamma0_ = late.second;
    gamma1_ = late.first * early.second;
  } else {
    gamma0_ = gamma;
    gamma1_ = VectorXd::Zero(n);
  }
  output_ = C;
  const Eigen::ComplexSchur<Eigen::MatrixXcd> schur(phi_.cast<Complex>());
  triangle_ = schur.matrixT();
  input0_ = schur.matrixU().adjoint() * gamma0_.cast<Complex>();
  input1_ = schur.matrixU().adjoint() * gamma1_.cast<Complex>();
  out_ = output_.cast<Complex>() * schur.matrixU();
  poles_ = triangle_.diagonal();
}

Complex SampledLinearPlant::operator()(Complex delta) const {
  const Complex z = 1.0 + delta;
  const Eigen::Index n = triangle_.rows();
  Eigen::VectorXcd x = input0_ + input1_ / z;
  Complex y = 0;
  for (Eigen::Index i = n; i-- > 0;) {
    x(i) /= delta + (1.0 - triangle_(i, i));
    if (i > 0) x.head(i) += x(i) * triangle_.col(i).head(i);
    y += out_(i) * x(i);
  }
  return y * std::pow(z, -whole_delay_);
}

Eigen::VectorXcd closed_loop_poles(const SampledLinearPlant& plant, const LoopTiming& timing, const WallGains& gains) {
  const Eigen::Index n = plant.phi().rows();
  const Eigen::Index history = timing.delay_samples + plant.whole_delay_samples() + (plant.gamma1().isZero(0) ? 0 : 1);
  const Eigen::Index size = n + 1 + history;
  const double a = timing.filter_pole(), slope = gains.damping_Ns_per_m * (1 - a) / timing.sample_time_s;
  // u = -(K + slope) y - w,  w+ = a w + slope (a - 1) y; the newest force first in the history
  MatrixXd M = MatrixXd::Zero(size, size);
  Eigen::RowVectorXd u = Eigen::RowVectorXd::Zero(size);
  u.head(n) = -(gains.stiffness_N_per_m + slope) * plant.output();
  u(n) = -1;
  M.block(n, 0, 1, n) = slope * (a - 1) * plant.output();
  M(n, n) = a;
  M.topLeftCorner(n, n) = plant.phi();
  const auto force = [&](Eigen::Index age) {  // u[k - age] as a row over the states
    if (age == 0) return u;
    Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero(size);
    row(n + age) = 1;
    return row;
  };
  const Eigen::Index age = timing.delay_samples + plant.whole_delay_samples();
  M.topRows(n) += plant.gamma0() * force(age);
  if (!plant.gamma1().isZero(0)) M.topRows(n) += plant.gamma1() * force(age + 1);
  for (Eigen::Index i = 1; i <= history; ++i) M.row(n + i) = force(i - 1);
  return Eigen::EigenSolver<MatrixXd>(M, false).eigenvalues();
}

LoopResponse loop_response(const SampledLinearPlant& plant, const LoopTiming& timing, const WallGains& gains,
                           double frequency) {
  const Complex delta = LoopFunction::delta_at(frequency * timing.sample_time_s).std();
  const double one_minus_a = -std::expm1(-2 * std::numbers::pi * timing.cutoff_Hz * timing.sample_time_s);
  LoopResponse r;
  r.plant = plant(delta);
  r.wall = gains.stiffness_N_per_m +
           gains.damping_Ns_per_m * one_minus_a / timing.sample_time_s * delta / (delta + one_minus_a);
  r.loop = r.wall * r.plant * std::pow(1.0 + delta, -timing.delay_samples);
  r.sensitivity = 1.0 / (1.0 + r.loop);
  r.complementary_sensitivity = r.loop * r.sensitivity;
  return r;
}

Margins evaluate(const SampledLinearPlant& plant, const LoopTiming& timing, const WallGains& gains) {
  require_valid(timing);
  Margins m;
  const Eigen::VectorXcd poles = closed_loop_poles(plant, timing, gains);
  m.rho = poles.cwiseAbs().maxCoeff();
  m.stable = m.rho < 1;
  if (!m.stable) return m;
  MarginCollector collector(m);
  const double T = timing.sample_time_s, nyquist = std::numbers::pi / T;
  if (gains.stiffness_N_per_m == 0 && gains.damping_Ns_per_m == 0) {
    collector.distance(0.0, 1.0, 0.0);
    collector.finish();
    return m;
  }
  FrequencyGrid grid(1e-5 * nyquist, nyquist);
  grid.add_logarithmic(100);
  grid.add_even(100 + 40 * (timing.delay_samples + plant.whole_delay_samples()));
  const auto crowd = [&](const Eigen::VectorXcd& set) {
    for (const Complex z : set) {
      if (std::abs(z) > 0.5 && z.imag() > 0)
        grid.add_resonance(std::arg(z) / T, std::max(std::abs(1 - std::abs(z)), 1e-12) / T);
    }
  };
  crowd(poles);
  crowd(plant.poles());
  scan_response(
      grid.sorted(),
      [&](double w) {
        return ResponsePoint{loop_response(plant, timing, gains, w).loop, 1.0};
      },
      collector);
  for (const double w : {0.0, nyquist}) {
    const Complex L = loop_response(plant, timing, gains, w).loop;
    if (!std::isfinite(L.real()) || std::abs(L) > 1e12) continue;  // a pole there
    collector.phase_crossing(L.real(), w);
    collector.distance(L, 1.0, w);
  }
  collector.finish();
  return m;
}

Margins evaluate(const models::AxisModel& model, const models::AxisOperatingPoint& point, double tip_mass_kg,
                 double tip_damping_Ns_per_m, const LoopTiming& timing, const WallGains& gains) {
  return evaluate(
      SampledLinearPlant(linear_plant(model, point, tip_mass_kg, tip_damping_Ns_per_m), timing.sample_time_s), timing,
      gains);
}

}  // namespace handloop::control
