#include "models/phantom.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>

#include "models/errors.h"
#include "models/random.h"
#include "models/transducers.h"

namespace handloop::models {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

Eigen::Vector3d degrees(double q1, double q2, double q3) {
  return kDegree * Eigen::Vector3d(q1, q2, q3);
}

/// Poses within the limits, away from their ends.
std::vector<Eigen::Vector3d> poses(int count) {
  const CounterRandom random(1, RandomStream::test);
  std::vector<Eigen::Vector3d> found;
  for (std::uint64_t i = 0; static_cast<int>(found.size()) < count; ++i) {
    const auto u = random.uniforms(i);
    const Eigen::Vector3d q = degrees(-80 + 160 * u[0], -60 + 150 * u[1], -20 + 140 * u[2]);
    if (within_limits(q)) found.push_back(q);
  }
  return found;
}

class Phantom : public testing::TestWithParam<PhantomParameterSet> {
 protected:
  PhantomParameters bare = phantom_parameters(GetParam());
  PhantomParameters held = phantom_parameters(GetParam(), 0.052);
};
INSTANTIATE_TEST_SUITE_P(Sets, Phantom, testing::Values(PhantomParameterSet::cavusoglu, PhantomParameterSet::cad),
                         [](const auto& one) { return std::string(phantom_parameter_set_name(one.param)); });

TEST_P(Phantom, HomeIsForwardByOneLinkAndDownByTheOther) {
  EXPECT_LT((phantom_tip(bare, Eigen::Vector3d::Zero()) - Eigen::Vector3d(bare.l1_m, 0, -bare.l2_m)).norm(), 1e-15);
}

TEST_P(Phantom, InverseUndoesForward) {
  for (const auto& q : poses(200)) {
    // The elbow-up branch: q3 - q2 + 90 deg is the elbow's inner angle, 0 to 180 deg.
    if (q[2] - q[1] < -85 * kDegree || q[2] - q[1] > 85 * kDegree) continue;
    if (bare.l1_m * std::cos(q[1]) + bare.l2_m * std::sin(q[2]) < 0.01) continue;  // tip behind the base axis
    EXPECT_LT((phantom_inverse(bare, phantom_tip(bare, q)) - q).norm(), 1e-9) << q.transpose();
  }
}

TEST_P(Phantom, RefusesPointsOutOfReach) {
  EXPECT_THROW(phantom_inverse(bare, {0.4, 0, 0}), InputError);
  EXPECT_THROW(phantom_inverse(bare, {0.01, 0, 0}), InputError);
}

TEST_P(Phantom, JacobianIsTheDerivativeOfTheTip) {
  for (const auto& q : poses(20)) {
    const auto j = phantom_jacobian(bare, q);
    for (int k = 0; k < 3; ++k) {
      Eigen::Vector3d step = Eigen::Vector3d::Zero();
      step[k] = 1e-5;
      const Eigen::Vector3d difference = (phantom_tip(bare, q + step) - phantom_tip(bare, q - step)) / 2e-5;
      EXPECT_LT((difference - j.col(k)).norm(), 1e-10);  // residual 2e-11
    }
    const double r = bare.l1_m * std::cos(q[1]) + bare.l2_m * std::sin(q[2]);
    EXPECT_NEAR(j.determinant(), r * bare.l1_m * bare.l2_m * std::cos(q[1] - q[2]), 1e-15);
  }
}

TEST_P(Phantom, MassMatrixIsPositiveDefiniteEverywhere) {
  for (const auto& q : poses(200)) {
    const Eigen::Matrix3d m = phantom_mass_matrix(bare, q);
    EXPECT_LT((m - m.transpose()).norm(), 1e-18);
    EXPECT_GT(Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(m).eigenvalues().minCoeff(), 1e-4);
  }
}

TEST_P(Phantom, DynamicsDoNotDependOnTheBaseAngle) {
  for (auto q : poses(20)) {
    const auto m = phantom_mass_matrix(held, q);
    const auto n = phantom_gravity(held, q);
    q[0] += 0.7;
    EXPECT_LT((phantom_mass_matrix(held, q) - m).norm(), 1e-16);
    EXPECT_LT((phantom_gravity(held, q) - n).norm(), 1e-15);
  }
}

// Energy: N is the gradient of the potential energy, here of the tip mass alone (the difference of two devices).
TEST_P(Phantom, GravityOfTheTipMassIsTheGradientOfItsHeight) {
  for (const auto& q : poses(20)) {
    const Eigen::Vector3d difference = phantom_gravity(held, q) - phantom_gravity(bare, q);
    for (int k = 0; k < 3; ++k) {
      Eigen::Vector3d step = Eigen::Vector3d::Zero();
      step[k] = 1e-5;
      const double slope = (phantom_tip(bare, q + step)[2] - phantom_tip(bare, q - step)[2]) / 2e-5;
      EXPECT_NEAR(difference[k], 0.052 * bare.gravity_m_per_s2 * slope, 1e-9);
    }
  }
}

// M' - 2 C is skew symmetric, so the power of the Coriolis torques is half that of M': q'^T (M'/2 - C) q' = 0.
TEST_P(Phantom, CoriolisTorquesConserveEnergy) {
  const CounterRandom random(2, RandomStream::test);
  std::uint64_t n = 0;
  for (const auto& q : poses(50)) {
    const Eigen::Vector3d rate(random.normal(n), random.normal(n + 1), random.normal(n + 2));
    n += 3;
    const double h = 1e-4;
    const Eigen::Matrix3d m_rate =
        (phantom_mass_matrix(held, q + h * rate) - phantom_mass_matrix(held, q - h * rate)) / (2 * h);
    EXPECT_NEAR(rate.dot(phantom_coriolis(held, q, rate)), 0.5 * rate.dot(m_rate * rate), 2e-9);  // difference quotient
  }
}

// Lagrange's equations from the kinetic energy alone: C q' = d/dt(M q') - dT/dq by numerical differentiation.
TEST_P(Phantom, CoriolisTorquesFollowLagrange) {
  const Eigen::Vector3d q = degrees(30, -15, 40), rate(1.1, -0.7, 0.4);
  const double h = 1e-4;
  Eigen::Vector3d expected =
      (phantom_mass_matrix(held, q + h * rate) - phantom_mass_matrix(held, q - h * rate)) / (2 * h) * rate;
  for (int k = 0; k < 3; ++k) {
    Eigen::Vector3d step = Eigen::Vector3d::Zero();
    step[k] = h;
    expected[k] -=
        0.5 *
        (rate.dot(phantom_mass_matrix(held, q + step) * rate) - rate.dot(phantom_mass_matrix(held, q - step) * rate)) /
        (2 * h);
  }
  EXPECT_LT((phantom_coriolis(held, q, rate) - expected).norm(), 1e-10);
}

TEST_P(Phantom, TipMassAddsToTheInertiaAtTheTip) {
  for (const auto& q : poses(20)) {
    const Eigen::Matrix3d bare_inertia = phantom_tip_mobility(bare, q).inverse();
    const Eigen::Matrix3d held_inertia = phantom_tip_mobility(held, q).inverse();
    EXPECT_LT((held_inertia - bare_inertia - 0.052 * Eigen::Matrix3d::Identity()).norm(), 1e-10 * held_inertia.norm());
  }
}

/// Numbers of an independent rigid-body calculation; masses in 1e-4 kg m^2, torques in Nm, as printed to four decimals.
struct Oracle {
  Eigen::Vector3d pose_deg;
  double m11, m22, m33, m23, m12, m13, n2, n3;
};

void expect_oracle(const PhantomParameters& device, const Oracle& o) {
  const Eigen::Vector3d q = kDegree * o.pose_deg;
  const Eigen::Matrix3d m = 1e4 * phantom_mass_matrix(device, q);
  EXPECT_NEAR(m(0, 0), o.m11, 1e-4);
  EXPECT_NEAR(m(1, 1), o.m22, 1e-4);
  EXPECT_NEAR(m(2, 2), o.m33, 1e-4);
  EXPECT_NEAR(m(1, 2), o.m23, 1e-4);
  EXPECT_NEAR(m(0, 1), o.m12, 1e-4);
  EXPECT_NEAR(m(0, 2), o.m13, 1e-4);
  const auto n = phantom_gravity(device, q);
  EXPECT_NEAR(n[0], 0, 1e-15);
  EXPECT_NEAR(n[1], o.n2, 1e-5);
  EXPECT_NEAR(n[2], o.n3, 1e-5);
}

TEST(PhantomOracle, CadSetAtThreePoses) {
  const auto device = phantom_parameters(PhantomParameterSet::cad);
  for (const Oracle& o :
       {Oracle{{0, 0, 0}, 39.9487, 27.2364, 8.8878, 0.0013, -0.0044, -0.5218, -0.01168, 0.00129},
        Oracle{{0, 20, 30}, 42.4139, 27.2364, 8.8878, 0.6521, 0.1493, -0.4707, -0.01092, -0.04251},
        Oracle{{30, -15, 40}, 46.3204, 27.2364, 8.8878, 3.0707, -0.1204, -0.4239, -0.01133, -0.05510}}) {
    expect_oracle(device, o);
  }
}

TEST(PhantomOracle, CavusogluSetAtThreePoses) {
  const auto device = phantom_parameters(PhantomParameterSet::cavusoglu);
  for (const Oracle& o : {Oracle{{0, 0, 0}, 35.7348, 24.2640, 9.3189, 0, 0, 0, -0.01630, 0},
                          Oracle{{0, 20, 30}, 39.3291, 24.2640, 9.3189, 0.7921, 0, 0, -0.01532, -0.03688},
                          Oracle{{30, -15, 40}, 43.1154, 24.2640, 9.3189, 3.7366, 0, 0, -0.01574, -0.04741}}) {
    expect_oracle(device, o);
  }
}

// The published closed form of set B, written out: an equation, not rigid bodies.
TEST(PhantomOracle, RigidBodiesOfCavusogluGiveThePublishedFormula) {
  const double l1 = 0.215, l2 = 0.170, l3 = 0.0325, ma = 0.0202, mc = 0.0249;
  const double a_xx = 0.4864e-4, a_yy = 0.001843e-4, a_zz = 0.4864e-4, c_xx = 0.959e-4, c_yy = 0.959e-4,
               c_zz = 0.0051e-4;
  const double be_xx = 11.09e-4, be_yy = 10.06e-4, be_zz = 0.591e-4, df_xx = 7.11e-4, df_yy = 0.629e-4,
               df_zz = 6.246e-4;
  const double base = 11.87e-4;
  const auto device = phantom_parameters(PhantomParameterSet::cavusoglu);
  for (const auto& q : poses(50)) {
    const double m11 = (8 * base + 4 * (a_yy + a_zz + be_yy + be_zz + c_yy + c_zz + df_yy + df_zz) + 4 * l1 * l1 * ma +
                        l2 * l2 * ma + l1 * l1 * mc + 4 * l3 * l3 * mc) /
                           8 +
                       (4 * (be_yy - be_zz + c_yy - c_zz) + l1 * l1 * (4 * ma + mc)) / 8 * std::cos(2 * q[1]) +
                       (4 * (a_yy - a_zz + df_yy - df_zz) - l2 * l2 * ma - 4 * l3 * l3 * mc) / 8 * std::cos(2 * q[2]) +
                       l1 * (l2 * ma + l3 * mc) * std::cos(q[1]) * std::sin(q[2]);
    const double m22 = be_xx + c_xx + l1 * l1 * (ma + mc / 4);
    const double m33 = a_xx + df_xx + l2 * l2 * ma / 4 + l3 * l3 * mc;
    const double m23 = -l1 * (l2 * ma + l3 * mc) / 2 * std::sin(q[1] - q[2]);
    Eigen::Matrix3d expected;
    expected << m11, 0, 0, 0, m22, m23, 0, m23, m33;
    EXPECT_LT((phantom_mass_matrix(device, q) - expected).norm(), 1e-17);  // residual 2e-18
  }
}

// Computed outside of this project, grams at the home pose; the device's axes x fore-aft, y lateral, z up are the
// hand's z, x, y.
TEST(PhantomOracle, TipInertiaAtHome) {
  const Eigen::Vector3d home = Eigen::Vector3d::Zero();
  const auto grams = [&](PhantomParameters device, double rotor, Axis axis) {
    device.rotor_inertia_kg_m2 = rotor;
    return 1e3 * phantom_tip_inertia_kg(device, home, axis);
  };
  const auto a = phantom_parameters(PhantomParameterSet::cad), b = phantom_parameters(PhantomParameterSet::cavusoglu);
  EXPECT_NEAR(grams(a, 0, Axis::z), 30.9, 0.05);
  EXPECT_NEAR(grams(a, 0, Axis::x), 91, 0.5);
  EXPECT_NEAR(grams(a, 0, Axis::y), 62, 0.5);
  EXPECT_NEAR(grams(b, 0, Axis::z), 32, 0.5);
  EXPECT_NEAR(grams(b, 0, Axis::x), 77, 0.5);
  EXPECT_NEAR(grams(b, 0, Axis::y), 52, 0.5);
  const double rotor = phantom_drive().motor.rotor_inertia_kg_m2;
  EXPECT_NEAR(grams(a, rotor, Axis::z), 35, 0.5);
  EXPECT_NEAR(grams(a, rotor, Axis::x), 95, 0.5);
  EXPECT_NEAR(grams(a, rotor, Axis::y), 65, 0.5);
  EXPECT_NEAR(grams(b, rotor, Axis::z), 37, 0.5);
  EXPECT_NEAR(grams(b, rotor, Axis::x), 81, 0.5);
  EXPECT_NEAR(grams(b, rotor, Axis::y), 55, 0.5);
}

// Static balance of the forearm: the tip mass that cancels N3 at q3 = 90 deg.
TEST(PhantomOracle, ForearmIsBalancedByAboutTheMassOfTheStylus) {
  const Eigen::Vector3d raised = degrees(0, 40, 90);
  for (const auto& [set, grams] : {std::pair{PhantomParameterSet::cad, 52.5}, {PhantomParameterSet::cavusoglu, 44.0}}) {
    const auto device = phantom_parameters(set);
    EXPECT_NEAR(-1e3 * phantom_gravity(device, raised)[2] / device.gravity_m_per_s2 / device.l2_m, grams, 0.6);
  }
}

}  // namespace
}  // namespace handloop::models
