#include "models/arm_uncertainty.h"

#include <gtest/gtest.h>

#include "models/errors.h"

namespace handloop::models {
namespace {

// Peaks over 0.6 to 30 Hz computed outside of this project from Table IV (NumPy on a 20,000-point grid), dB to 0.1.
TEST(ArmUncertainty, PeaksAreThoseOfTheTable) {
  EXPECT_NEAR(peak(uncertainty(Axis::x, UncertaintySet::maximum)).magnitude_dB, 3.2, 0.1);
  EXPECT_NEAR(peak(uncertainty(Axis::y, UncertaintySet::maximum)).magnitude_dB, 5.9, 0.1);
  EXPECT_NEAR(peak(uncertainty(Axis::z, UncertaintySet::maximum)).magnitude_dB, 3.6, 0.1);
  EXPECT_NEAR(peak(uncertainty(Axis::x, UncertaintySet::percentile67)).magnitude_dB, -2.9, 0.1);
  EXPECT_NEAR(peak(uncertainty(Axis::y, UncertaintySet::percentile67)).magnitude_dB, -0.4, 0.1);
  EXPECT_NEAR(peak(uncertainty(Axis::z, UncertaintySet::percentile67)).magnitude_dB, -6.5, 0.1);
}

TEST(ArmUncertainty, PrintedZBreaksThePapersOwnBoundAndStaysOnRecord) {
  EXPECT_NEAR(peak(uncertainty_as_printed(Axis::z, UncertaintySet::percentile67)).magnitude_dB, 32.6, 0.1);
  EXPECT_TRUE(is_corrected(Axis::z, UncertaintySet::percentile67));
}

// The paper's section III-B2: maximum under 10 dB and 67 % under 0 dB on all axes.
TEST(ArmUncertainty, KeepsTheBoundsThePaperStates) {
  for (const Axis axis : kAxes) {
    EXPECT_LT(peak(uncertainty(axis, UncertaintySet::maximum)).magnitude_dB, 10);
    EXPECT_LT(peak(uncertainty(axis, UncertaintySet::percentile67)).magnitude_dB, 0);
  }
}

TEST(ArmUncertainty, IsStableMinimumPhaseAndBiproper) {
  for (const Axis axis : kAxes) {
    for (const auto set : {UncertaintySet::maximum, UncertaintySet::percentile67}) {
      const auto& model = uncertainty(axis, set);
      for (const auto& root : model.zeros) EXPECT_LT(root.real(), 0);
      for (const auto& root : model.poles) EXPECT_LT(root.real(), 0);
      EXPECT_LE(model.zeros.size(), model.poles.size());
      // Real coefficients: the value at the conjugate is the conjugate.
      const std::complex<double> s(-0.3, 40);
      EXPECT_LT(std::abs(model(std::conj(s)) - std::conj(model(s))), 1e-12 * std::abs(model(s)));
    }
  }
}

TEST(ArmUncertainty, RefusesAnUnknownSet) {
  EXPECT_THROW(parse_uncertainty_set("95"), InputError);
}

}  // namespace
}  // namespace handloop::models
