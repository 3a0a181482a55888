#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>

#include "control/force_control.h"
#include "models/errors.h"

/// Performance, stability and the norm of Kazerooni and Her's force control against calculations made elsewhere.
namespace handloop::control {
namespace {

using Complex = std::complex<double>;

ForceControl printed(double alpha_x, double alpha_y) {
  ForceControl c;
  c.K = {{0.0198}, {2.7e-5, 2.7e-3, 0.09, 1}};
  c.alpha = diagonal_matrix({{alpha_x}, {1}}, {{alpha_y}, {1}});
  c.environment_kg *= models::kPrintedEnvironmentMass_kg;
  return c;
}

/// Area under |g| by brute force: the impulse response by exact steps of the companion form, trapezoids between.
double area_by_steps(const TransferFunction& f, double step_s, double end_s) {
  const auto den = trimmed(f.denominator);
  const auto num = trimmed(f.numerator);
  const std::size_t n = den.size() - 1;
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(n), static_cast<Eigen::Index>(n));
  A.topRightCorner(A.rows() - 1, A.rows() - 1).setIdentity();
  for (std::size_t i = 0; i < n; ++i) A(A.rows() - 1, static_cast<Eigen::Index>(i)) = -den[n - i] / den[0];
  // e^(A h) by its series, h small against every mode
  Eigen::MatrixXd E = Eigen::MatrixXd::Identity(A.rows(), A.rows()), term = E;
  for (int k = 1; k < 40; ++k) {
    term = (term * A * step_s / k).eval();
    E += term;
  }
  std::vector<double> x(n, 0.0), next(n);
  x.back() = 1.0;
  const auto output = [&] {
    double g = 0;
    for (std::size_t i = 0; i < num.size(); ++i) g += num[num.size() - 1 - i] / den[0] * x[i];
    return std::abs(g);
  };
  double area = 0, before = output();
  for (double t = 0; t < end_s; t += step_s) {
    for (std::size_t i = 0; i < n; ++i) {
      next[i] = 0;
      for (std::size_t k = 0; k < n; ++k)
        next[i] += E(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) * x[k];
    }
    x.swap(next);
    const double here = output();
    area += 0.5 * step_s * (before + here);
    before = here;
  }
  return area;
}

TEST(ANorm, IsExactWhereTheAreaIsKnown) {
  const double pi = std::numbers::pi;
  EXPECT_NEAR(a_norm({{3}, {1, 2}}).value, 1.5, 1e-9);           // 1.5e-10
  EXPECT_NEAR(a_norm({{1}, {1, 4, 4}}).value, 0.25, 1e-9);       // a double pole; 1e-11
  EXPECT_NEAR(a_norm({{1}, {1, 6, 12, 8}}).value, 0.125, 1e-8);  // a triple one; 1e-10
  // e^(-at) sin wt: coth(a pi/(2 w)) w/(a^2 + w^2)
  for (const auto& [a, w] : {std::pair{0.5, 4.0}, {0.01, 30.0}, {3.0, 1.0}}) {
    const double exact = w / (a * a + w * w) / std::tanh(a * pi / (2 * w));
    const auto norm = a_norm({{w}, {1, 2 * a, a * a + w * w}});
    EXPECT_NEAR(norm.value / exact, 1.0, 1e-9);
    EXPECT_LT(norm.error_bound, 1e-8 * exact);
  }
  // 2 e^-2t - e^-t changes its sign at ln 2: areas 1/4 and 1/4
  EXPECT_NEAR(a_norm({{1, 0}, {1, 3, 2}}).value, 0.5, 1e-10);
}

TEST(ANorm, OfThePapersLoopIsThatOfAStepByStepCalculation) {
  for (const double alpha : {5.0, 8.0}) {
    const auto compliance = closed_compliance(printed(alpha, alpha)).entries[0][0];
    const auto norm = a_norm(compliance);
    const double steps = area_by_steps(compliance, 1e-5, 8.0);
    EXPECT_NEAR(norm.value / steps, 1.0, 1e-6) << alpha;
    EXPECT_LT(norm.error_bound, 1e-6 * norm.value);
  }
}

TEST(ANorm, IsInfiniteWhereTheLoopIsUnstable) {
  EXPECT_TRUE(std::isinf(small_gain(printed(8, 19)).gain_m_per_N));
  EXPECT_THROW(a_norm({{1, 0}, {1, 1}}), InputError);
}

TEST(ForceControl, CompliancesOfATurnedPlaneHaveTheSameModes) {
  // alpha turned by 30 degrees couples x and y; its eigenvalues are the same, and so is the determinant's stability.
  const double c = std::cos(0.5), s = std::sin(0.5);
  auto turned = printed(8, 5);
  const Eigen::Matrix2d R = (Eigen::Matrix2d() << c, -s, s, c).finished();
  const Eigen::Matrix2d alpha = R * Eigen::Vector2d(8, 5).asDiagonal() * R.transpose();
  for (std::size_t i = 0; i < 2; ++i) {
    for (std::size_t k = 0; k < 2; ++k) {
      turned.alpha.entries[i][k] = {{alpha(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k))}, {1}};
    }
  }
  const auto straight = closed_compliance(printed(8, 5)), coupled = closed_compliance(turned);
  for (const double w : {0.1, 3.0, 40.0, 200.0}) {
    const Complex jw(0, w);
    const Eigen::Matrix2cd expected = R.cast<Complex>() * straight(jw) * R.transpose().cast<Complex>();
    EXPECT_LT((coupled(jw) - expected).norm(), 1e-9 * expected.norm()) << w;
  }
  // and the A-norms of the coupled entries by brute force: polynomials of degree 12 over one determinant
  const auto norm = a_norm(coupled.entries[0][1]);
  EXPECT_NEAR(norm.value / area_by_steps(coupled.entries[0][1], 2e-5, 8.0), 1.0, 1e-5);
  EXPECT_TRUE(std::isfinite(small_gain(turned).gain_m_per_N));
  auto wild = turned;
  for (auto& row : wild.alpha.entries) {
    for (auto& entry : row) entry.numerator[0] *= 2.0;  // eigenvalues 16 and 10
  }
  EXPECT_TRUE(std::isinf(small_gain(wild).gain_m_per_N));
}

TEST(ForceControl, LimitOfTheClosedFormIsThatOfThePoles) {
  const Sensitivity none;
  const auto limit = axis_limit(printed(8, 5), none, 1);
  ASSERT_TRUE(limit);
  EXPECT_NEAR(limit->factor, 12.499, 0.001);
  EXPECT_TRUE(evaluate(axis_loop(printed(limit->factor * 0.9999, 5), 0)).margins.stable);
  EXPECT_FALSE(evaluate(axis_loop(printed(limit->factor * 1.0001, 5), 0)).margins.stable);
  const auto together = amplification_limit(printed(8, 5), none);
  ASSERT_TRUE(together);
  EXPECT_NEAR(8 * together->factor, limit->factor, 1e-6);
}

struct Stiff final : Sensitivity {
  Eigen::Matrix2cd to_hand(double w) const override { return Eigen::Matrix2cd::Identity() * Complex(1e-6, -1e-8 * w); }
  Eigen::Matrix2cd to_environment(double w) const override { return 2.0 * to_hand(w); }
};

TEST(ForceControl, InequalityNineSufficesForEightWhereGKIsTheSameInBothAxes) {
  const Stiff stiff;
  const auto c = printed(8, 5);
  bool both = false, neither = false;
  for (const double epsilon : {1e-5, 1e-4, 1e-3, 1e-2, 0.1}) {
    const auto p = performance(c, stiff, 6.28, epsilon);
    EXPECT_TRUE(p.met_8 || !p.met_9) << epsilon;
    both = both || p.met_9;
    neither = neither || !p.met_8;
  }
  EXPECT_TRUE(both && neither);
  // Without sensitivities the performance is R whatever K is.
  const auto exact = performance(c, Sensitivity{}, 6.28, 1e-3);
  EXPECT_LT(exact.worst_error, 1e-14);
  EXPECT_TRUE(exact.met_8 && exact.met_9);
}

TEST(ForceControl, PerformanceMayBeAnyTransferMatrix) {
  // R = m s + b felt along x: alpha = 1/(m s + b), a lag.
  auto c = printed(8, 5);
  c.alpha = diagonal_matrix({{1}, {0.02, 0.1}}, {{5}, {1}});
  EXPECT_LT(performance(c, Sensitivity{}, 6.28, 1e-3).worst_error, 1e-13);
  EXPECT_TRUE(std::isfinite(small_gain(c).gain_m_per_N));
  EXPECT_TRUE(evaluate(axis_loop(c, 0)).margins.stable);
  // A cubic spring's gain passes through alpha: |alpha|_A = 10 of the lag, 5 of the constant.
  EXPECT_NEAR(cubic_gain_N_per_m(c, 1000, 0.1), 10 * 1000 * 0.01, 1e-6);
}

TEST(DiscreteFilter, FollowsItsTransferFunctionAndRefusesWhatCannotRun) {
  constexpr double T = 2e-4;
  const TransferFunction K{{0.0198}, {2.7e-5, 2.7e-3, 0.09, 1}};
  DiscreteFilter filter(K, T);
  const double w = 2 * std::numbers::pi * 35;
  Complex sum = 0;
  const int period = static_cast<int>(std::round(1 / (35 * T)) * 35);
  for (int k = 0; k < 5 * period; ++k) {
    const double y = filter.step(std::cos(w * k * T));
    if (k >= 4 * period) sum += y * std::exp(Complex(0, -w * k * T));
  }
  const Complex response = 2.0 * sum / static_cast<double>(period);
  EXPECT_LT(std::abs(response / K({0, w}) - 1.0), 2e-3);  // 6e-4
  EXPECT_THROW(DiscreteFilter({{1, 0, 0}, {1, 1}}, T), InputError);
  EXPECT_THROW(DiscreteFilter({{1}, {1, -1}}, T), InputError);
  EXPECT_THROW(DiscreteFilter({{1}, {0}}, T), InputError);
}

}  // namespace
}  // namespace handloop::control
