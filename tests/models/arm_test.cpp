#include "models/arm.h"

#include <gtest/gtest.h>

#include "models/errors.h"

namespace handloop::models {
namespace {

constexpr ArmParameters kNominalX{0.2179, 379.5, 78.75, 1.839, 4.645};

std::complex<double> ratio(const ArmParameters& arm, std::complex<double> s) {
  const auto n = compliance_numerator(arm);
  const auto d = compliance_denominator(arm);
  return ((n[0] * s + n[1]) * s + n[2]) / (((d[0] * s + d[1]) * s + d[2]) * s + d[3]);
}

TEST(Arm, SumOfGraspAndArmEqualsEquationOne) {
  for (double w = 0.01; w < 1e4; w *= 1.7) {
    const std::complex<double> s(0, w);
    EXPECT_LT(std::abs(compliance(kNominalX, s) / ratio(kNominalX, s) - 1.0), 1e-12);
  }
}

TEST(Arm, PolesAreRootsOfTheDenominator) {
  const auto d = compliance_denominator(kNominalX);
  for (const auto& p : compliance_poles(kNominalX)) {
    EXPECT_LT(std::abs(((d[0] * p + d[1]) * p + d[2]) * p + d[3]), 1e-6 * d[3]);
  }
}

TEST(Arm, RefusesWhatCannotBe) {
  ArmParameters arm = kNominalX;
  EXPECT_NO_THROW(require_valid(arm));
  arm.mass_kg = -1;
  EXPECT_THROW(require_valid(arm), InputError);
  arm.mass_kg = std::nan("");
  EXPECT_THROW(require_valid(arm), InputError);
}

}  // namespace
}  // namespace handloop::models
