#include "identify/arm_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "models/errors.h"
#include "tests/support/arm_recording.h"

namespace handloop::identify {
namespace {

using Complex = std::complex<double>;
using models::ArmParameters;

/// Eq. (1) as printed, at the paper's 57 bins; written out here, not taken from the model.
FrequencyResponse exact_response(const std::array<double, 5>& arm) {
  const auto [M, k1, k2, b1, b2] = arm;
  FrequencyResponse out;
  for (int n = 1; n <= 57; ++n) {
    const double f = n / 1.914;
    const Complex s(0, 2 * std::numbers::pi * f);
    out.frequency_Hz.push_back(f);
    out.response.push_back((M * s * s + (b1 + b2) * s + k1 + k2) /
                           (b1 * M * s * s * s + (b1 * b2 + k1 * M) * s * s + (b2 * k1 + b1 * k2) * s + k1 * k2));
    out.coherence.push_back(1.0);
    out.variance.push_back(0.0);
  }
  return out;
}

TEST(ArmFit, FindsEveryArmOfThePublishedRangesFromAnExactResponse) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const auto& arm : test::random_arms(axis, 100, 7)) {
      const auto fit = fit_arm(exact_response(arm));
      const auto found = models::to_array(fit.arm);
      for (std::size_t i = 0; i < 5; ++i) {
        EXPECT_NEAR(found[i], arm[i], 1e-5 * arm[i] + 2e-6) << "axis " << axis << " " << models::kArmParameterNames[i];
      }
    }
  }
}

TEST(ArmFit, FindsTheArmsOfTheLiterature) {
  // Table V: Diaz, Speich X, Z, 1DOF. (Speich Y and Vlugt have mass or stiffness far outside what 30 Hz can show.)
  for (const auto& arm : {std::array<double, 5>{0.22, 3662, 98.6, 1.18, 6.88},
                          {0.85, 122, 330, 12.9, 12.9},
                          {0.68, 81.4, 13.0, 17.6, 13.5},
                          {1.46, 48.8, 375, 4.5, 7.9}}) {
    const auto found = models::to_array(fit_arm(exact_response(arm)).arm);
    for (std::size_t i = 0; i < 5; ++i) EXPECT_NEAR(found[i] / arm[i], 1, 1e-3) << arm[1] << " " << i;
  }
}

TEST(ArmFit, IntervalsHoldTheTruthNineteenTimesInTwenty) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  const std::array<double, 5> truth{0.2179, 379.5, 78.75, 1.839, 4.645};
  std::array<int, 5> inside{};
  constexpr int kRepetitions = 300;
  for (int repetition = 0; repetition < kRepetitions; ++repetition) {
    auto measured = exact_response(truth);
    for (std::size_t n = 0; n < measured.size(); ++n) {
      const double error = 0.02 * std::abs(measured.response[n]);
      measured.variance[n] = 2 * error * error;
      measured.response[n] += error * Complex(normal(random), normal(random));
    }
    ArmFitSettings settings;
    settings.error_correlation = {1, 0, 0};
    const auto fit = fit_arm(measured, settings);
    for (std::size_t i = 0; i < 5; ++i) inside[i] += fit.low95[i] <= truth[i] && truth[i] <= fit.high95[i];
  }
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_GT(inside[i], 0.92 * kRepetitions)
        << models::kArmParameterNames[i];  // 0.95 +- 0.013; wider where the misfit is
    EXPECT_LT(inside[i], 0.995 * kRepetitions) << models::kArmParameterNames[i];
  }
}

TEST(ArmFit, SaysWhichParameterIsNotDetermined) {
  // b1 of 0.002 N s/m turns the phase by 0.02 degrees at 30 Hz; noise of 1 % hides it.
  auto measured = exact_response({0.2357, 886.9, 365.8, 0.002, 20.14});
  std::mt19937_64 random(8);
  std::normal_distribution<double> normal;
  for (std::size_t n = 0; n < measured.size(); ++n) {
    const double error = 0.01 * std::abs(measured.response[n]);
    measured.variance[n] = 2 * error * error;
    measured.response[n] += error * Complex(normal(random), normal(random));
  }
  const auto fit = fit_arm(measured);
  ASSERT_FALSE(fit.warnings.empty());
  bool named = false;
  for (const auto& warning : fit.warnings) named = named || warning.find("b1_Ns_per_m") != std::string::npos;
  EXPECT_TRUE(named);
  EXPECT_TRUE(fit_arm(exact_response({0.3240, 459.4, 104.8, 2.579, 5.920})).warnings.empty());
}

TEST(ArmFit, CoherenceDecidesHowMuchAFrequencyCounts) {
  auto measured = exact_response({0.2179, 379.5, 78.75, 1.839, 4.645});
  for (std::size_t n = 20; n < 30; ++n) {
    measured.response[n] *= 1.5;  // spoilt by something that is not the force
    measured.coherence[n] = 0;
  }
  EXPECT_NEAR(fit_arm(measured).arm.mass_kg, 0.2179, 1e-6);
  ArmFitSettings unweighted;
  unweighted.weight = FitWeight::none;
  EXPECT_GT(std::abs(fit_arm(measured, unweighted).arm.mass_kg - 0.2179), 1e-3);
}

TEST(ArmFit, StaysWithinItsBounds) {
  ArmFitSettings settings;
  settings.bounds.upper.k1_N_per_m = 300;
  const auto fit = fit_arm(exact_response({0.2179, 379.5, 78.75, 1.839, 4.645}), settings);
  EXPECT_LE(fit.arm.k1_N_per_m, 300);
  EXPECT_TRUE(fit.at_bound[1]);
}

TEST(ArmFit, RefusesTooFewFrequencies) {
  auto measured = exact_response({0.2179, 379.5, 78.75, 1.839, 4.645});
  for (std::size_t n = 4; n < measured.size(); ++n) measured.coherence[n] = 0;
  EXPECT_THROW(fit_arm(measured), InputError);
}

}  // namespace
}  // namespace handloop::identify
