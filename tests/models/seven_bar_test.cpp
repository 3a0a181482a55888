#include "models/seven_bar.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>

#include "models/seven_bar_arm.h"

/// Closed forms of the linkage and the transfer functions that Kazerooni and Her print.
namespace handloop::models {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;
using Complex = std::complex<double>;

const SevenBarParameters kDevice;
const std::vector<Vector2d> kPoses{seven_bar_home(), {-1.2, 0.4}, {-2.2, -0.3}, {-0.8, 0.9}};

TEST(SevenBar, HasTheInertiaWorkedOutOutsideThisProject) {
  // Link by link from the same sections, heights of the links neglected there: 0.1 % apart at most.
  const auto loaded = seven_bar_inertia(kDevice);
  EXPECT_NEAR(loaded.a_kg_m2, 0.58831, 0.001 * 0.58831);
  EXPECT_NEAR(loaded.b_kg_m2, 0.65767, 0.001 * 0.65767);
  EXPECT_NEAR(loaded.c_kg_m2, 1.01574, 0.001 * 1.01574);
  EXPECT_NEAR(loaded.g3_Nm, 19.70, 0.01);
  EXPECT_NEAR(loaded.g6_Nm, 20.39, 0.01);
  auto bare = kDevice;
  bare.load_kg = 0.0;
  const auto own = seven_bar_inertia(bare);
  EXPECT_NEAR(own.a_kg_m2, 0.25689, 0.002 * 0.25689);
  EXPECT_NEAR(own.b_kg_m2, 0.12312, 0.002 * 0.12312);
  EXPECT_NEAR(own.c_kg_m2, 0.15357, 0.004 * 0.15357);
}

TEST(SevenBar, JacobianAndBiasAreDerivativesOfThePosition) {
  constexpr double h = 1e-6;
  for (const auto& th : kPoses) {
    const Matrix2d jacobian = seven_bar_jacobian(kDevice, th, kDevice.handle_m);
    for (int i = 0; i < 2; ++i) {
      Vector2d step = Vector2d::Zero();
      step[i] = h;
      const Vector2d slope = (seven_bar_handle(kDevice, th + step) - seven_bar_handle(kDevice, th - step)) / (2 * h);
      EXPECT_LT((slope - jacobian.col(i)).norm(), 1e-9);
    }
    const Vector2d rate(0.7, -1.1);
    const Matrix2d turned = (seven_bar_jacobian(kDevice, th + h * rate, kDevice.handle_m) -
                             seven_bar_jacobian(kDevice, th - h * rate, kDevice.handle_m)) /
                            (2 * h);
    EXPECT_LT((turned * rate - seven_bar_bias_acceleration(kDevice, th, rate)).norm(), 1e-8);
  }
}

TEST(SevenBar, CoriolisTorquesDoNoWorkBesideTheChangeOfInertia) {
  constexpr double h = 1e-6;
  const auto inertia = seven_bar_inertia(kDevice);
  for (const auto& th : kPoses) {
    const Vector2d rate(1.3, -0.4);
    const Matrix2d change =
        (seven_bar_mass_matrix(inertia, th + h * rate) - seven_bar_mass_matrix(inertia, th - h * rate)) / (2 * h);
    EXPECT_NEAR(rate.dot(seven_bar_coriolis(inertia, th, rate)), 0.5 * rate.dot(change * rate), 1e-8);
  }
}

TEST(SevenBar, LoadIsFeltAtTheHandleByEqualWork) {
  const Matrix2d home = seven_bar_environment_mass(kDevice, seven_bar_home());
  EXPECT_NEAR(home(1, 1), std::pow(0.5 / 0.3, 2) * 33.82 / 9.80665, 1e-9);
  EXPECT_NEAR(home(1, 1), 9.580, 0.001);           // where (19) prints 9.08
  EXPECT_NEAR(home(0, 0), 33.82 / 9.80665, 1e-9);  // moved by link 3 alone
  EXPECT_NEAR(home(0, 1), 0.0, 1e-12);
  auto bare = kDevice;
  bare.load_kg = 0.0;
  for (const auto& th : kPoses) {
    // What the load adds to the inertia at the handle is its environment mass.
    const Matrix2d added = seven_bar_handle_mass(kDevice, seven_bar_inertia(kDevice), th) -
                           seven_bar_handle_mass(bare, seven_bar_inertia(bare), th);
    EXPECT_LT((added - seven_bar_environment_mass(kDevice, th)).norm(), 1e-9);
  }
}

TEST(SevenBar, TransferFunctionsAreThoseOfThePaper) {
  const PrimaryLoop G;
  EXPECT_NEAR(std::abs(G(0.0) - 1.0), 0.0, 1e-15);
  for (const Complex pole : {Complex(-498.75, 0), Complex(-0.62528, 1.30124)}) {
    const Complex there = ((G.d3 * pole + 1.0) * pole + G.d1) * pole + G.d0;
    const Complex slope = (3 * G.d3 * pole + 2.0) * pole + G.d1;
    EXPECT_LT(std::abs(there / slope), 0.006);  // the printed digits of the roots: 0.0013 at -498.75
  }
  // 12.1 (s^2/43.69 + s/5.08 + 1) lbf/ft
  const double lbf_per_ft = 4.4482216152605 / 0.3048;
  const HandImpedance H;
  EXPECT_NEAR(H.stiffness_N_per_m, 12.1 * lbf_per_ft, 1e-4);
  EXPECT_NEAR(H.damping_Ns_per_m, 12.1 / 5.08 * lbf_per_ft, 1e-4);
  EXPECT_NEAR(H.mass_kg, 12.1 / 43.69 * lbf_per_ft, 1e-4);
}

TEST(NeuralArm, TightGripFollowsThePrintedImpedanceAndLooseGripYields) {
  const auto tight = neural_arm(SevenBarHand::tight), loose = neural_arm(SevenBarHand::loose);
  const HandImpedance printed;
  double worst_dB = 0, worst_deg = 0;
  for (double w = 0.1; w < 100; w *= 1.05) {
    const Complex s(0, w), ratio = tight.impedance(s) / printed(s);
    worst_dB = std::max(worst_dB, std::abs(20 * std::log10(std::abs(ratio))));
    worst_deg = std::max(worst_deg, std::abs(std::arg(ratio)) * 180 / std::numbers::pi);
    if (w < 3) {
      EXPECT_LT(std::abs(loose.impedance(s)), std::abs(tight.impedance(s)));
    }
  }
  EXPECT_LT(worst_dB, 0.6);   // 0.57
  EXPECT_LT(worst_deg, 4.0);  // 3.5
  // Mass alone at high frequency, for both: 40 dB a decade.
  for (const auto& arm : {tight, loose}) {
    const double decade = std::abs(arm.impedance({0, 1000})) / std::abs(arm.impedance({0, 100}));
    EXPECT_NEAR(20 * std::log10(decade), 40, 0.1);
  }
  // Without feedback H is G_p, and feedback divides the force at rest.
  EXPECT_EQ(neural_arm(SevenBarHand::printed).impedance({0, 3}), neural_arm(SevenBarHand::printed).tissue({0, 3}));
  EXPECT_NEAR(loose.impedance(1e-9).real(), 25.0, 1e-6);
}

TEST(NeuralArm, ItsFeedbackIsStableWithTheNeuralDelay) {
  // 1 + G_f G_a has no zero in the right half plane: its Nyquist curve does not go round the origin.
  for (const auto hand : {SevenBarHand::tight, SevenBarHand::loose}) {
    const auto arm = neural_arm(hand);
    double turned = 0;
    Complex before = 1.0 + arm.feedback({0, 1e-6}) * arm.activation({0, 1e-6});
    for (double w = 1e-4; w < 1e5; w *= 1.01) {
      const Complex here = 1.0 + arm.feedback({0, w}) * arm.activation({0, w});
      turned += std::arg(here / before);
      before = here;
    }
    EXPECT_LT(std::abs(turned), 0.1);
  }
}

}  // namespace
}  // namespace handloop::models
