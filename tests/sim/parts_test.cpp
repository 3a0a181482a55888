#include <gtest/gtest.h>

#include <complex>
#include <numbers>

#include "sim/coloured_noise.h"
#include "sim/delay_line.h"
#include "sim/exponential_step.h"

namespace handloop::sim {
namespace {

TEST(ExponentialStep, IsExactForALinearSystemWhateverTheStep) {
  Eigen::Matrix2d linear;
  linear << 0, 1, -4e6, -3e4;  // an arm of a third of a gram
  const ExponentialStep step(linear, 1e-3);
  const Eigen::Vector2d none[4] = {};
  Eigen::Vector2d zero[4];
  for (auto& n : zero) n.setZero();
  const Eigen::Vector2d start(1e-3, 0.2), end = step.stage(4, start, zero);
  // closed form by the two real poles
  const double root = std::sqrt(3e4 * 3e4 - 4 * 4e6), p = (-3e4 + root) / 2, q = (-3e4 - root) / 2;
  const double b = (start[1] - p * start[0]) / (q - p), a = start[0] - b;
  EXPECT_NEAR(end[0], a * std::exp(p * 1e-3) + b * std::exp(q * 1e-3), 1e-15);
  EXPECT_NEAR(end[1], a * p * std::exp(p * 1e-3) + b * q * std::exp(q * 1e-3), 1e-12);
  static_cast<void>(none);
}

TEST(ExponentialStep, IsExactForAConstantInput) {
  Eigen::Matrix2d linear;
  linear << 0, 1, -900, -5;
  const ExponentialStep step(linear, 0.01);
  const Eigen::Vector2d input(0, 3.0);
  Eigen::Vector2d n[4];
  for (auto& each : n) each = input;
  Eigen::Vector2d y(0, 0);
  for (int i = 0; i < 2000; ++i) y = step.stage(4, y, n);
  EXPECT_NEAR(y[0], 3.0 / 900, 1e-12);  // where it comes to rest
}

TEST(ExponentialStep, IsTheClassicalMethodWithoutALinearPart) {
  const ExponentialStep step(Eigen::Matrix2d::Zero(), 0.1);
  const Eigen::Vector2d y(1, 2);
  Eigen::Vector2d n[4] = {{1, 0}, {0, 1}, {2, 2}, {3, -1}};
  EXPECT_LT((step.stage(1, y, n) - (y + 0.05 * n[0])).norm(), 1e-15);
  EXPECT_LT((step.stage(2, y, n) - (y + 0.05 * n[1])).norm(), 1e-15);
  EXPECT_LT((step.stage(3, y, n) - (y + 0.1 * n[2])).norm(), 1e-15);
  EXPECT_LT((step.stage(4, y, n) - (y + 0.1 / 6 * (n[0] + 2 * n[1] + 2 * n[2] + n[3]))).norm(), 1e-15);
}

TEST(DelayLine, RemembersACubicExactly) {
  const auto at = [](double t) { return DelayLine::Motion{t * t * t - 2 * t, 3 * t * t - 2}; };
  DelayLine line(0.0237, 0.01);
  for (int i = 0; i <= 10; ++i) line.push(0.01 * i, at(0.01 * i));
  for (const double t : {0.1, 0.105, 0.11}) {
    EXPECT_NEAR(line.at_delay(t, at(t)).x_m, at(t - 0.0237).x_m, 1e-15);
    EXPECT_NEAR(line.at_delay(t, at(t)).v_m_per_s, at(t - 0.0237).v_m_per_s, 1e-13);
  }
}

TEST(DelayLine, LooksWithinTheStepWhereTheDelayIsShorter) {
  const auto at = [](double t) { return DelayLine::Motion{t * t, 2 * t}; };
  DelayLine line(0.004, 0.01);
  line.push(0.0, at(0.0));
  EXPECT_NEAR(line.at_delay(0.01, at(0.01)).x_m, at(0.006).x_m, 1e-15);
}

TEST(DelayLine, WasAtRestBeforeItBegan) {
  DelayLine line(0.05, 0.01);
  line.push(0.0, {0.3, 9.0});
  EXPECT_EQ(line.at_delay(0.0, {0.3, 9.0}).x_m, 0.3);
  EXPECT_EQ(line.at_delay(0.0, {0.3, 9.0}).v_m_per_s, 0.0);
}

TEST(ButterworthLowPass, HasTheThirteenthOrderShape) {
  ButterworthLowPass filter(13, 30.0, 1000.0);
  std::vector<double> impulse;
  for (int i = 0; i < 8192; ++i) impulse.push_back(filter.filter(i == 0 ? 1.0 : 0.0));
  for (const double f : {1.0, 15.0, 28.0, 30.0, 33.0, 40.0, 60.0}) {
    std::complex<double> response = 0;
    for (std::size_t n = 0; n < impulse.size(); ++n) {
      response += impulse[n] * std::polar(1.0, -2 * std::numbers::pi * f * static_cast<double>(n) * 1e-3);
    }
    const double warped = std::tan(std::numbers::pi * f * 1e-3) / std::tan(std::numbers::pi * 0.03);
    const double expected = 1 / std::sqrt(1 + std::pow(warped, 26));
    EXPECT_NEAR(std::abs(response) / expected, 1.0, 1e-6) << f << " Hz";
  }
}

TEST(ColouredNoise, HasUnitRmsAndRepeats) {
  ColouredNoise noise(3, models::RandomStream::test, 0, 1000.0);
  std::vector<double> first;
  double sum = 0;
  for (int i = 0; i < 200000; ++i) {
    first.push_back(noise.next());
    sum += first.back() * first.back();
  }
  EXPECT_NEAR(sum / 200000, 1.0, 0.03);  // some 12000 independent values: 1.3 % standard error
  noise.reset();
  for (int i = 0; i < 1000; ++i) EXPECT_EQ(noise.next(), first[static_cast<std::size_t>(i)]);
}

}  // namespace
}  // namespace handloop::sim
