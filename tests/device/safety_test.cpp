#include "device/safety.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "device/scales.h"
#include "tests/device/fake_plant.h"

namespace handloop::device {
namespace {

constexpr double kT = 1e-3;

/// A tip that moves along x as a function of time, seen by the monitor; sensors read zero and tremble.
FaultEvent watch(const SafetyLimits& limits, const std::function<double(double)>& x_m, double seconds,
                 double* when_s = nullptr) {
  FakePlant plant;
  MotionMonitor monitor(limits, plant.description());
  FakeMechanism mechanism;
  Reading reading;
  reading.adc_codes.fill(32768);
  for (int k = 0; k < static_cast<int>(seconds / kT); ++k) {
    const auto state = mechanism.at({x_m(k * kT) / FakeMechanism::kLever_m, 0.0, 0.0});
    reading.encoder_counts.fill(k);
    for (std::size_t i = 0; i < 3; ++i) reading.adc_codes[i] = 32768 + static_cast<std::uint32_t>(k % 3);
    const auto event = monitor.check(reading, state, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(), 1);
    if (event.fault != Fault::none) {
      if (when_s != nullptr) *when_s = k * kT;
      return event;
    }
  }
  return {};
}

TEST(Safety, ASlowHandIsNoFault) {
  const auto sway = [](double t) { return 0.05 * std::sin(2.0 * std::numbers::pi * 2.0 * t); };  // 0.63 m/s, 7.9 m/s^2
  EXPECT_EQ(watch({}, sway, 5.0).fault, Fault::none);
}

TEST(Safety, SpeedOverTheLimitIsFoundWithinTenMilliseconds) {
  SafetyLimits limits;
  limits.workspace_radius_m = 10.0;
  limits.acceleration_m_per_s2 = 1e6;
  double when_s = 0.0;
  const auto event = watch(
      limits, [](double t) { return t < 0.1 ? 0.0 : 2.4 * (t - 0.1); }, 1.0, &when_s);
  EXPECT_EQ(event.fault, Fault::velocity);
  EXPECT_GT(event.value, event.limit);
  EXPECT_EQ(event.limit, 2.0);
  EXPECT_LT(when_s, 0.11);
}

TEST(Safety, SpeedJustUnderTheLimitIsNot) {
  SafetyLimits limits;
  limits.workspace_radius_m = 10.0;
  limits.acceleration_m_per_s2 = 1e6;
  EXPECT_EQ(watch(
                limits, [](double t) { return 1.98 * t; }, 1.0)
                .fault,
            Fault::none);
}

TEST(Safety, AccelerationOverTheLimitIsFound) {
  SafetyLimits limits;
  limits.acceleration_m_per_s2 = 100.0;
  // 12 Hz and 25 mm: 1.9 m/s and 142 m/s^2 at most, of which the 30 Hz filter passes 93 %.
  const auto shake = [](double t) { return 0.025 * std::sin(2.0 * std::numbers::pi * 12.0 * t); };
  limits.velocity_m_per_s = 3.0;
  EXPECT_EQ(watch(limits, shake, 1.0).fault, Fault::acceleration);
  limits.acceleration_m_per_s2 = 250.0;
  EXPECT_EQ(watch(limits, shake, 1.0).fault, Fault::none);
}

TEST(Safety, TheWorkspaceIsABallAboutThePose) {
  SafetyLimits limits;
  limits.home_tip_m = {0.2, 0.0, 0.0};
  limits.workspace_radius_m = 0.1;
  const auto away = [](double t) { return 0.2 + 0.3 * t; };
  double when_s = 0.0;
  const auto event = watch(limits, away, 1.0, &when_s);
  EXPECT_EQ(event.fault, Fault::workspace);
  EXPECT_NEAR(when_s, 0.1 / 0.3, 2e-3);
}

TEST(Safety, ALeapIsAJumpHoweverShort) {
  const auto leap = [](double t) { return t < 0.5 ? 0.0 : 0.02; };
  EXPECT_EQ(watch({}, leap, 1.0).fault, Fault::encoder_jump);
}

TEST(Safety, TheForceLimiterKeepsTheDirection) {
  SafetyLimits limits;
  limits.force_N = 3.0;
  limits.force_rate_N_per_s = 1e9;
  ForceLimiter limiter(limits, kT);
  bool clipped = false;
  const Eigen::Vector3d wanted(4.0, -3.0, 12.0);
  const Eigen::Vector3d given = limiter.limit(wanted, clipped);
  EXPECT_TRUE(clipped);
  EXPECT_NEAR(given.norm(), 3.0, 1e-12);
  EXPECT_NEAR(given.normalized().dot(wanted.normalized()), 1.0, 1e-12);
  EXPECT_EQ(limiter.limit({1.0, 1.0, 1.0}, clipped), Eigen::Vector3d(1.0, 1.0, 1.0));
  EXPECT_FALSE(clipped);
}

TEST(Safety, ASpringObservedIsPassiveAndItsEnergyComesBack) {
  PassivityObserver observer(1.0, 1e-5);
  // In and out of a spring of 500 N/m, in steps of a micrometre: E = -K x^2 / 2 on the way in, 0 after the way out.
  constexpr double kStep_m = 1e-6, kStiffness = 500.0;
  double x = 0.0, force = 0.0, deepest = 0.0;
  for (int k = 0; k < 20000; ++k) {
    const double step = k < 10000 ? kStep_m : -kStep_m;
    x += step;
    observer.update({force, 0, 0}, {step, 0, 0}, true);
    deepest = std::min(deepest, observer.energy_J());
    force = -kStiffness * x;
  }
  EXPECT_NEAR(deepest, -0.5 * kStiffness * 0.01 * 0.01, 1e-5);
  // The force is held from the sample before: each step gives away K step^2, in all 10 uJ (residual 10.0).
  EXPECT_NEAR(observer.energy_J(), 2 * 10000 * kStiffness * kStep_m * kStep_m / 2, 1e-7);
}

TEST(Safety, CreditEndsWithTheContactAndASurplusFades) {
  PassivityObserver observer(1.0, kT);
  observer.update({-5.0, 0, 0}, {0.1, 0, 0}, true);
  EXPECT_NEAR(observer.energy_J(), -0.5, 1e-12);
  observer.update({0, 0, 0}, {0, 0, 0}, false);
  EXPECT_EQ(observer.energy_J(), 0.0);
  observer.update({5.0, 0, 0}, {0.1, 0, 0}, true);
  for (int k = 0; k < 1000; ++k) observer.update({0, 0, 0}, {0, 0, 0}, false);
  EXPECT_NEAR(observer.energy_J(), 0.5 * std::exp(-1.0), 1e-9);
  for (int k = 0; k < 100; ++k) observer.update({-5.0, 0, 0}, {0.1, 0, 0}, true);
  EXPECT_EQ(observer.energy_J(), -2.0);  // credit is bounded
}

TEST(Scales, CodesAndVoltsAreInverseAndZeroIsTheNearestFromAbove) {
  const FakePlant plant;
  const auto& d = plant.description();
  EXPECT_EQ(zero_code(d), 2048u);
  EXPECT_NEAR(dac_volts(d, zero_code(d)), 10.0 / 4095.0, 1e-12);
  for (std::uint32_t code = 0; code < 4096; ++code) EXPECT_EQ(dac_code(d, dac_volts(d, code)), code);
  EXPECT_EQ(dac_code(d, 1e9), 4095u);
  EXPECT_EQ(dac_code(d, -1e9), 0u);
  EXPECT_EQ(torque_code(d, 0, std::nan("")), zero_code(d));
  EXPECT_NEAR(code_torque_Nm(d, 0, 4095), 3.0 * 11.2 * 0.0234, 1e-12);
  EXPECT_NEAR(code_torque_Nm(d, 0, torque_code(d, 0, 0.3)), 0.3, 0.5 * 4.9e-3 * 0.3 * 11.2 * 0.0234);
}

TEST(Scales, UnwrappingFollowsAnyNumberOfFolds) {
  EncoderUnwrap unwrap;
  std::int64_t truth = 5;
  std::array<std::int64_t, kMaxMotors> seen{};
  for (int k = 0; k < 40; ++k) {
    seen = unwrap.update({static_cast<std::int32_t>(static_cast<std::uint32_t>(truth)), 0, 0});
    EXPECT_EQ(seen[0], truth);
    truth += k < 20 ? 1'500'000'000 : -2'000'000'000;
  }
}

}  // namespace
}  // namespace handloop::device
