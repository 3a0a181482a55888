#pragma once

#include <Eigen/Core>
#include <array>
#include <complex>
#include <string_view>

namespace handloop::models {

/// The five-parameter arm of one axis (Fu and Cavusoglu, Figure 4): the hand holds the stylus through the grasp
/// (k1, b1), behind it the mass of the arm hangs on the arm's own spring and damper (k2, b2) to the resting body.
struct ArmParameters {
  double mass_kg = 0.0;
  double k1_N_per_m = 0.0;   ///< grasp stiffness
  double k2_N_per_m = 0.0;   ///< arm stiffness
  double b1_Ns_per_m = 0.0;  ///< grasp damping
  double b2_Ns_per_m = 0.0;  ///< arm damping

  bool operator==(const ArmParameters&) const = default;
};

/// Names of the five parameters in the order of every table and file: mass, k1, k2, b1, b2.
inline constexpr std::array<std::string_view, 5> kArmParameterNames{"mass_kg", "k1_N_per_m", "k2_N_per_m",
                                                                    "b1_Ns_per_m", "b2_Ns_per_m"};

/// The five values in the order of kArmParameterNames, and back.
std::array<double, 5> to_array(const ArmParameters& arm);
ArmParameters arm_from_array(const std::array<double, 5>& values);

/// Throws InputError naming the parameter unless all are finite, the mass and k1 positive and the others not negative.
void require_valid(const ArmParameters& arm);

/// Compliance H(s) = X/F in m/N of eq. (1): position of the grip over force at the grip, s in rad/s.
/// Evaluated as 1/(b1 s + k1) + 1/(M s^2 + b2 s + k2), which is the same function: with a massless stylus the grasp and
/// the arm share the force and add their motions.
std::complex<double> compliance(const ArmParameters& arm, std::complex<double> s);

/// Coefficients of eq. (1), highest power first: numerator (3) and denominator (4).
std::array<double, 3> compliance_numerator(const ArmParameters& arm);
std::array<double, 4> compliance_denominator(const ArmParameters& arm);

/// Poles of H in rad/s: the grasp's -k1/b1 and the pair of the arm. With b1 = 0 there is no grasp pole (two values).
Eigen::VectorXcd compliance_poles(const ArmParameters& arm);
/// Zeros of H in rad/s.
Eigen::VectorXcd compliance_zeros(const ArmParameters& arm);

}  // namespace handloop::models
