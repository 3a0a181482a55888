#include "models/arm.h"

#include <cmath>
#include <string>

#include "models/errors.h"

namespace handloop::models {
namespace {

using Complex = std::complex<double>;

/// Roots of a x^2 + b x + c for a > 0 without cancellation.
std::array<Complex, 2> quadratic_roots(double a, double b, double c) {
  const double discriminant = b * b - 4 * a * c;
  if (discriminant < 0) {
    const Complex root(-b / (2 * a), std::sqrt(-discriminant) / (2 * a));
    return {root, std::conj(root)};
  }
  const double q = -0.5 * (b + std::copysign(std::sqrt(discriminant), b));
  if (q == 0) return {Complex(0), Complex(0)};
  return {Complex(q / a), Complex(c / q)};
}

}  // namespace

std::array<double, 5> to_array(const ArmParameters& arm) {
  return {arm.mass_kg, arm.k1_N_per_m, arm.k2_N_per_m, arm.b1_Ns_per_m, arm.b2_Ns_per_m};
}

ArmParameters arm_from_array(const std::array<double, 5>& values) {
  return {values[0], values[1], values[2], values[3], values[4]};
}

void require_valid(const ArmParameters& arm) {
  const auto values = to_array(arm);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const bool must_be_positive = i < 2;
    if (!std::isfinite(values[i]) || values[i] < 0 || (must_be_positive && values[i] == 0)) {
      throw InputError(std::string(kArmParameterNames[i]) + " = " + std::to_string(values[i]) +
                       " is not possible: it must be a finite number " +
                       (must_be_positive ? "above zero" : "of zero or more"));
    }
  }
}

Complex compliance(const ArmParameters& arm, Complex s) {
  return 1.0 / (arm.b1_Ns_per_m * s + arm.k1_N_per_m) +
         1.0 / ((arm.mass_kg * s + arm.b2_Ns_per_m) * s + arm.k2_N_per_m);
}

std::array<double, 3> compliance_numerator(const ArmParameters& arm) {
  return {arm.mass_kg, arm.b1_Ns_per_m + arm.b2_Ns_per_m, arm.k1_N_per_m + arm.k2_N_per_m};
}

std::array<double, 4> compliance_denominator(const ArmParameters& arm) {
  return {arm.b1_Ns_per_m * arm.mass_kg, arm.b1_Ns_per_m * arm.b2_Ns_per_m + arm.k1_N_per_m * arm.mass_kg,
          arm.b2_Ns_per_m * arm.k1_N_per_m + arm.b1_Ns_per_m * arm.k2_N_per_m, arm.k1_N_per_m * arm.k2_N_per_m};
}

Eigen::VectorXcd compliance_poles(const ArmParameters& arm) {
  const auto pair = quadratic_roots(arm.mass_kg, arm.b2_Ns_per_m, arm.k2_N_per_m);
  if (arm.b1_Ns_per_m == 0) return Eigen::Vector2cd(pair[0], pair[1]);
  return Eigen::Vector3cd(Complex(-arm.k1_N_per_m / arm.b1_Ns_per_m), pair[0], pair[1]);
}

Eigen::VectorXcd compliance_zeros(const ArmParameters& arm) {
  const auto [a, b, c] = compliance_numerator(arm);
  const auto pair = quadratic_roots(a, b, c);
  return Eigen::Vector2cd(pair[0], pair[1]);
}

}  // namespace handloop::models
