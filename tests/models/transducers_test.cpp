#include "models/transducers.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "models/phantom.h"

namespace handloop::models {
namespace {

TEST(Encoder, CountsEdgesDownwardsThroughZero) {
  const Encoder encoder;
  const double one = encoder.resolution_rad();
  EXPECT_EQ(encoder.counts(0.5 * one), 0);
  EXPECT_EQ(encoder.counts(-0.5 * one), -1);
  EXPECT_EQ(encoder.counts(1000.5 * one), 1000);
  for (double angle = -3; angle < 3; angle += 0.01) {
    const double error = angle - encoder.angle_rad(encoder.counts(angle));
    EXPECT_GE(error, -1e-12);
    EXPECT_LE(error, one + 1e-12);
  }
  EXPECT_EQ(encoder.counts(1e9), std::numeric_limits<std::int32_t>::max());
}

// 0.02945 mm by the upper link (FACTS: 860 dpi is 0.0295 mm), 0.0233 mm by the forearm, 0.0248 mm sideways.
TEST(Encoder, ResolutionAtTheTipIsThatOfTheDataSheet) {
  const auto device = phantom_parameters(PhantomParameterSet::cavusoglu);
  const auto ratio = phantom_drive().ratio;
  EXPECT_NEAR(1e3 * device.l1_m * Encoder{}.resolution_rad() / ratio[1], 0.02945, 5e-6);
  EXPECT_NEAR(1e3 * device.l2_m * Encoder{}.resolution_rad() / ratio[2], 0.0233, 5e-5);
  EXPECT_NEAR(1e3 * device.l1_m * Encoder{}.resolution_rad() / ratio[0], 0.0248, 5e-5);
}

TEST(Dac, ZeroVoltsIsNotACode) {
  const Converter dac;
  EXPECT_NEAR(1e3 * dac.step_V(), 4.884, 5e-4);
  EXPECT_NEAR(1e3 * dac.volt(2047), -2.44, 5e-3);
  EXPECT_NEAR(1e3 * dac.volt(2048), 2.44, 5e-3);
  EXPECT_EQ(dac.code(0), 2048u);
}

TEST(Dac, ClipsAtItsEndsAndRoundsToTheNearestCode) {
  const Converter dac;
  EXPECT_EQ(dac.code(-11), 0u);
  EXPECT_EQ(dac.code(11), 4095u);
  EXPECT_EQ(dac.code(std::nan("")), 2048u);
  EXPECT_EQ(dac.volt(5000), 10);
  for (std::uint32_t code = 0; code <= dac.maximum_code(); ++code) EXPECT_EQ(dac.code(dac.volt(code)), code);
  for (double volt = -10; volt <= 10; volt += 0.00137) {
    EXPECT_LE(std::abs(dac.volt(dac.code(volt)) - volt), dac.step_V() / 2 + 1e-12);
  }
}

TEST(Adc, SixteenBitsResolve305Microvolts) {
  EXPECT_NEAR((1e6 * Converter{16, 10}.step_V()), 305, 0.5);
}

TEST(Amplifier, StopsAtItsCurrentLimit) {
  const Amplifier amplifier;
  EXPECT_DOUBLE_EQ(amplifier.current_A(5), 1.5);
  EXPECT_DOUBLE_EQ(amplifier.current_A(12), 3);
  EXPECT_DOUBLE_EQ(amplifier.current_A(-12), -3);
  EXPECT_DOUBLE_EQ(amplifier.volt(amplifier.current_A(4)), 4);
}

// Force at the tip: 28.6 mNm continuous is 1.49 N at l1; stall 129 mNm is 8.50 N at l2, the maker's maximum; 3 A give
// 3.66 to 5.49 N by axis and arm.
TEST(Drive, ForcesAtTheTipAreThoseOfTheDataSheet) {
  const auto drive = phantom_drive();
  EXPECT_NEAR(drive.ratio[1] * 28.6e-3 / 0.215, 1.49, 0.005);
  EXPECT_NEAR(drive.joint_torque_Nm(2, drive.motor.stall_current_A) / 0.170, 8.5, 0.05);
  EXPECT_NEAR(drive.joint_torque_Nm(1, 3) / 0.215, 3.66, 0.005);
  EXPECT_NEAR(drive.joint_torque_Nm(0, 3) / 0.170, 5.49, 0.005);
  EXPECT_DOUBLE_EQ(drive.current_A(0, drive.joint_torque_Nm(0, 1.7)), 1.7);
}

}  // namespace
}  // namespace handloop::models
