#include "identify/envelope.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "identify/variability.h"
#include "models/arm_tables.h"
#include "tests/support/arm_responses.h"

namespace handloop::identify {
namespace {

using Complex = std::complex<double>;

struct Curve {
  std::vector<double> f, dB;
};

double magnitude_dB(const models::UncertaintyModel& v, double f) {
  return 20 * std::log10(std::abs(v(Complex(0, 2 * std::numbers::pi * f))));
}

Curve curve_of(const models::UncertaintyModel& v) {
  Curve c;
  for (int n = 1; n <= 57; ++n) {
    c.f.push_back(n / 1.914);
    c.dB.push_back(magnitude_dB(v, c.f.back()));
  }
  return c;
}

void expect_admissible(const Envelope& e, const Curve& c) {
  EXPECT_GE(e.least_excess_dB, 0.0);
  EXPECT_LE(e.model.poles.size(), 5u);
  EXPECT_EQ(e.model.zeros.size(), e.model.poles.size());
  for (const auto& p : e.model.poles) EXPECT_LT(p.real(), 0);
  for (const auto& z : e.model.zeros) EXPECT_LT(z.real(), 0);
  // What it says of itself, computed anew; and nothing dips below the straight lines between the data.
  double mean = 0;
  for (std::size_t n = 0; n < c.f.size(); ++n) {
    const double excess = magnitude_dB(e.model, c.f[n]) - c.dB[n];
    EXPECT_GE(excess, 0.0);
    mean += excess / static_cast<double>(c.f.size());
    if (n == 0) continue;
    // Bins at the lower end are an octave apart: a narrow pair must not dip, nor stick out, between two of them.
    for (int k = 1; k < 16; ++k) {
      const double share = k / 16.0, line = (1 - share) * c.dB[n - 1] + share * c.dB[n];
      const double over = magnitude_dB(e.model, (1 - share) * c.f[n - 1] + share * c.f[n]) - line;
      EXPECT_GE(over, -0.1);  // worst found: -0.08
      EXPECT_LE(over, 1.5);   // 0.75
    }
  }
  EXPECT_NEAR(mean, e.mean_excess_dB, 1e-9);
}

// Half a dozen random spreads of arms, and three with ripples no transfer function of order 10 can follow.
TEST(Envelope, LiesOnTheDataAndNeverBelow) {
  const std::array<models::ArmParameters, 3> nominal{
      models::nominal_arm(models::Axis::x), models::nominal_arm(models::Axis::y), models::nominal_arm(models::Axis::z)};
  for (int axis = 0; axis < 3; ++axis) {
    const auto responses = test::arms_as_responses(axis, 45, 9);
    const auto w = unstructured_variability(responses, nominal[static_cast<std::size_t>(axis)]);
    for (const auto& dB : {w.maximum_dB, w.percentile67_dB}) {
      const Curve c{w.frequency_Hz, dB};
      const auto e = fit_envelope(c.f, c.dB);
      expect_admissible(e, c);
      EXPECT_LT(e.mean_excess_dB, 0.2) << axis;  // found: 0.009 - 0.107
      // The published tables, lifted until they clear the same data, are far looser.
      for (const auto set : {models::UncertaintySet::maximum, models::UncertaintySet::percentile67}) {
        EXPECT_LT(e.mean_excess_dB,
                  lifted_envelope(models::uncertainty(static_cast<models::Axis>(axis), set), c.f, c.dB).mean_excess_dB);
      }
    }
  }
}

TEST(Envelope, RecoversThePublishedModelsFromTheirOwnMagnitudes) {
  for (const auto axis : models::kAxes) {
    for (const auto set : {models::UncertaintySet::maximum, models::UncertaintySet::percentile67}) {
      const Curve c = curve_of(models::uncertainty(axis, set));
      const auto e = fit_envelope(c.f, c.dB);
      expect_admissible(e, c);
      EXPECT_LT(e.mean_excess_dB, 0.2) << models::axis_name(axis);  // found: 0.007 - 0.061
    }
  }
}

TEST(Envelope, AFlatLineIsAGain) {
  const std::vector<double> f{1, 2, 5, 10}, dB(4, -6.0);
  EnvelopeSettings settings;
  settings.most_pairs = 0;
  const auto e = fit_envelope(f, dB, settings);
  EXPECT_TRUE(e.model.poles.empty());
  EXPECT_NEAR(20 * std::log10(e.model.gain), -6, 1e-6);
  EXPECT_GE(e.least_excess_dB, 0);
}

TEST(Envelope, LiftingMovesTheGainAlone) {
  const auto& published = models::uncertainty(models::Axis::x, models::UncertaintySet::maximum);
  Curve c = curve_of(published);
  for (auto& v : c.dB) v += 3;
  c.dB[20] += 2;
  const auto e = lifted_envelope(published, c.f, c.dB);
  EXPECT_NEAR(e.least_excess_dB, 0, 1e-6);
  EXPECT_NEAR(e.model.gain / published.gain, std::pow(10, 5.0 / 20), 1e-6);
  EXPECT_NEAR(e.mean_excess_dB, 2.0 * 56 / 57, 1e-6);
}

}  // namespace
}  // namespace handloop::identify
