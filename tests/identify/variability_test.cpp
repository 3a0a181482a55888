#include "identify/variability.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "identify/minimum_circle.h"
#include "tests/support/arm_responses.h"

namespace handloop::identify {
namespace {

using Complex = std::complex<double>;

/// The smallest circle by trying every pair and triple: slow and plainly right.
Circle by_trying_all(const std::vector<Complex>& p) {
  Circle best{0, std::numeric_limits<double>::infinity()};
  auto consider = [&](Complex centre) {
    double radius = 0;
    for (const Complex& q : p) radius = std::max(radius, std::abs(q - centre));
    if (radius < best.radius) best = {centre, radius};
  };
  for (std::size_t i = 0; i < p.size(); ++i) {
    consider(p[i]);
    for (std::size_t j = i + 1; j < p.size(); ++j) {
      consider(0.5 * (p[i] + p[j]));
      for (std::size_t k = j + 1; k < p.size(); ++k) {
        // Equal distances from three points: two linear equations in the centre.
        const Complex u = p[j] - p[i], v = p[k] - p[i];
        const double det = u.real() * v.imag() - u.imag() * v.real();
        if (det == 0) continue;
        const double a = std::norm(u) / 2, b = std::norm(v) / 2;
        consider(p[i] + Complex((a * v.imag() - b * u.imag()) / det, (b * u.real() - a * v.real()) / det));
      }
    }
  }
  return best;
}

TEST(MinimumCircle, IsTheSmallestOfAllThatHoldThePoints) {
  std::mt19937_64 random(2);
  std::normal_distribution<double> normal;
  for (int repetition = 0; repetition < 60; ++repetition) {
    std::vector<Complex> points(static_cast<std::size_t>(1 + repetition % 14));
    for (auto& p : points) p = 1e-3 * Complex(normal(random), normal(random)) + Complex(5e-3, -2e-3);
    const Circle circle = minimum_circle(points), expected = by_trying_all(points);
    EXPECT_NEAR(circle.radius, expected.radius, 1e-15);  // residual 9e-19
    EXPECT_LT(std::abs(circle.centre - expected.centre), 1e-12);
    for (const auto& p : points) EXPECT_LE(std::abs(p - circle.centre), circle.radius * (1 + 1e-12));
  }
}

TEST(MinimumCircle, CopesWithEqualAndAlignedPoints) {
  const std::vector<Complex> one{{2, 3}};
  EXPECT_EQ(minimum_circle(one).radius, 0);
  const std::vector<Complex> same(7, Complex(1, 1));
  EXPECT_EQ(minimum_circle(same).radius, 0);
  const std::vector<Complex> line{{0, 0}, {1, 1}, {2, 2}, {4, 4}, {3, 3}};
  EXPECT_NEAR(minimum_circle(line).radius, 2 * std::numbers::sqrt2, 1e-14);
  EXPECT_LT(std::abs(minimum_circle(line).centre - Complex(2, 2)), 1e-14);
  const std::vector<Complex> square{{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  EXPECT_NEAR(minimum_circle(square).radius, std::numbers::sqrt2 / 2, 1e-14);
  EXPECT_THROW(minimum_circle({}), std::invalid_argument);
}

TEST(Describe, GivesTheEightStatisticsOfTableThree) {
  std::vector<double> values;
  for (int i = 45; i >= 1; --i) values.push_back(i);
  const auto s = describe(values);
  EXPECT_EQ(s.minimum, 1);
  EXPECT_EQ(s.maximum, 45);
  EXPECT_DOUBLE_EQ(s.mean, 23);
  EXPECT_NEAR(s.standard_deviation, std::sqrt(45.0 * 46 / 12), 1e-12);  // of 1..n, sample
  EXPECT_EQ(s.ci95_minimum, 3);                                         // 3/45 is the first share at or above 5 %
  EXPECT_EQ(s.ci67_minimum, 15);
  EXPECT_EQ(s.ci67_maximum, 31);
  EXPECT_EQ(s.ci95_maximum, 43);
  EXPECT_EQ(describe(values, models::PercentileReading::central).ci95_minimum, 2);
}

TEST(Variability, UnstructuredIsTheRelativeDistanceFromTheNominalArm) {
  const auto responses = test::arms_as_responses(0, 45, 4);
  const models::ArmParameters nominal{0.2179, 379.5, 78.75, 1.839, 4.645};
  const auto w = unstructured_variability(responses, nominal);
  for (std::size_t n = 0; n < w.frequency_Hz.size(); n += 8) {
    std::size_t above67 = 0, above95 = 0, above = 0;
    for (const auto& r : responses) {
      const Complex h = models::compliance(nominal, Complex(0, 2 * std::numbers::pi * w.frequency_Hz[n]));
      const double dB = 20 * std::log10(std::abs((r.response[n] - h) / h));
      above67 += dB > w.percentile67_dB[n] + 1e-9;
      above95 += dB > w.percentile95_dB[n] + 1e-9;
      above += dB > w.maximum_dB[n] + 1e-9;
    }
    EXPECT_EQ(above, 0u);
    EXPECT_EQ(above95, 2u);   // 43 of 45 at or below
    EXPECT_EQ(above67, 14u);  // 31 of 45 at or below
  }
}

TEST(Variability, CentralResponseIsNoFurtherFromAnyArmThanTheMean) {
  const auto responses = test::arms_as_responses(1, 45, 4);
  const auto centre = central_response(responses), mean = mean_response(responses);
  for (std::size_t n = 0; n < centre.size(); ++n) {
    double from_centre = 0, from_mean = 0;
    for (const auto& r : responses) {
      from_centre = std::max(from_centre, std::abs(r.response[n] - centre.response[n]));
      from_mean = std::max(from_mean, std::abs(r.response[n] - mean.response[n]));
    }
    EXPECT_LE(from_centre, from_mean * (1 + 1e-12));
  }
  EXPECT_NEAR(mean.coherence[3], 0.9, 1e-12);
  EXPECT_NEAR(mean.variance[3], 1e-10 / 45, 1e-20);
}

}  // namespace
}  // namespace handloop::identify
