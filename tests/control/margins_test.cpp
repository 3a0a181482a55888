#include "control/margins.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "control/transfer_loop.h"
#include "models/arm_tables.h"
#include "models/errors.h"
#include "models/random.h"

namespace handloop::control {
namespace {

using Complex = std::complex<double>;

/// Arms as Table III draws them and beyond, walls from hardly any to unstable, delays on both sides of the polynomial
/// route.
Loop random_loop(std::uint64_t index, int most_delay = 6) {
  const models::CounterRandom random(21, models::RandomStream::test);
  const auto u = random.uniforms(index), v = random.uniforms(index, 1), w = random.uniforms(index, 2);
  const auto between = [](double low, double high, double p) { return low * std::pow(high / low, p); };
  Loop loop;
  loop.plant = {between(0.03, 3, u[0]), between(0.002, 2, u[1]),
                models::ArmParameters{between(3e-4, 0.9, u[2]), between(100, 4000, u[3]), between(5, 600, v[0]),
                                      between(2e-4, 10, v[1]), between(0.1, 30, v[2])}};
  loop.timing = {between(3e-4, 3e-3, v[3]), static_cast<int>((most_delay + 1) * w[0]), between(30, 800, w[1])};
  loop.gains = {between(5, 3000, w[2]), w[3] < 0.2 ? 0.0 : between(0.01, 8, w[3])};
  return loop;
}

/// What a margin says is what happens: the loop put on the edge by just that much has a pole on the unit circle.
TEST(Margins, OfGainLeadToTheUnitCircle) {
  int checked = 0;
  for (std::uint64_t i = 0; i < 400; ++i) {
    const Loop loop = random_loop(i);
    const Margins m = evaluate(loop);
    if (!m.stable) continue;
    const auto plant = sample_plant(loop.plant, loop.timing.sample_time_s);
    const auto rho = [&](double k) {
      return closed_loop_poles(plant, loop.timing, {k * loop.gains.stiffness_N_per_m, k * loop.gains.damping_Ns_per_m})
          .rho();
    };
    if (std::isfinite(m.gain_up)) {
      ++checked;
      EXPECT_NEAR(rho(m.gain_up), 1, 1e-9) << i;
      EXPECT_LT(rho(1 + 0.999 * (m.gain_up - 1)), 1) << i;
      for (double share = 0.1; share < 0.95; share += 0.1) EXPECT_LT(rho(1 + share * (m.gain_up - 1)), 1) << i;
    }
    if (m.gain_down > 0) {
      EXPECT_NEAR(rho(m.gain_down), 1, 1e-9) << i;
    }
  }
  EXPECT_GT(checked, 100);
}

/// Against a plain search on a fine grid: never better than what is stated, and not much worse.
TEST(Margins, AreNeverBeatenByAFineGrid) {
  int checked = 0;
  for (std::uint64_t i = 0; i < 250; ++i) {
    const Loop loop = random_loop(1000 + i);
    const Margins m = evaluate(loop);
    if (!m.stable) continue;
    ++checked;
    const auto plant = sample_plant(loop.plant, loop.timing.sample_time_s);
    double modulus = 1e300, peak = 0, phase = 1e300, delay = 1e300;
    Complex last = 0;
    const double nyquist = std::numbers::pi / loop.timing.sample_time_s;
    constexpr int kPoints = 20000;
    for (int k = 0; k <= kPoints; ++k) {
      const double w = nyquist * std::pow(10.0, -5.0 * (1 - static_cast<double>(k) / kPoints));
      const Complex L = loop_response(plant, loop.timing, loop.gains, w).loop;
      modulus = std::min(modulus, std::abs(1.0 + L));
      peak = std::max(peak, std::abs((1.0 - L) / (1.0 + L)));
      if (k > 0 && (std::abs(L) > 1) != (std::abs(last) > 1)) {
        const double angle = std::arg(-L);
        phase = std::min(phase, std::abs(angle));
        delay = std::min(delay, (angle < 0 ? angle + 2 * std::numbers::pi : angle) / w);
      }
      last = L;
    }
    EXPECT_LE(m.modulus, modulus * (1 + 1e-12)) << i;
    EXPECT_GE(m.modulus, 0.95 * modulus - 1e-3) << i;
    EXPECT_LE(m.disk_alpha, 2 / peak * (1 + 1e-12)) << i;
    EXPECT_GE(m.disk_alpha, 0.95 * 2 / peak - 1e-3) << i;
    if (phase < 1e300) {
      EXPECT_NEAR(std::abs(m.phase_deg), phase * 180 / std::numbers::pi, 1.0) << i;
      EXPECT_NEAR(m.delay_s, delay, 0.02 * delay + 2e-5) << i;
    }
  }
  EXPECT_GT(checked, 80);
}

/// The poles found are all of them: their product with 1 is the characteristic polynomial's value there.
TEST(Margins, PolesMakeUpTheCharacteristicPolynomial) {
  for (std::uint64_t i = 0; i < 60; ++i) {
    Loop loop = random_loop(2000 + i, 3);
    if (loop.timing.delay_samples > 3) continue;
    const Margins m = evaluate(loop);
    if (!m.stable) continue;
    const auto plant = sample_plant(loop.plant, loop.timing.sample_time_s);
    const auto poles = closed_loop_poles(plant, loop.timing, loop.gains);
    EXPECT_LT(poles.rho(), 1);
    Complex value = 1;
    // prod (1 - p_i) = den(1) (1 + L(1)): the poles found make up the polynomial at z = 1
    for (int k = 0; k < poles.count; ++k) value *= 1.0 - poles.z[static_cast<std::size_t>(k)];
    Complex open = 1 - loop.timing.filter_pole();
    for (int s = 0; s < plant.section_count; ++s) open *= plant.sections[static_cast<std::size_t>(s)].a0;
    const Complex L = loop_response(plant, loop.timing, loop.gains, 0).loop;
    EXPECT_LT(std::abs(value / (open * (1.0 + L)) - 1.0), 1e-9) << i;
  }
}

/// Margins computed with 60 digits (mpmath: matrix exponential, then roots of polynomials), among them the fastest arms
/// of Table III and a loop three parts in ten million from instability.
TEST(Margins, MatchSixtyDigits) {
  struct Row {
    Loop loop;
    double rho, gain_up, gain_down, phase_deg, delay_s, modulus, disk;
  };
  const Row rows[] = {
#include "tests/control/sixty_digits.inc"
  };
  for (const Row& r : rows) {
    const Margins m = evaluate(r.loop);
    ASSERT_TRUE(m.stable);
    // absolute figures of the loop are good to about 1e-14, so small margins have fewer digits
    const auto near = [&](double value, double expected, double scale) {
      if (value == expected) return;
      EXPECT_NEAR(value, expected, 1e-9 * std::abs(expected) + 1e-13 * scale) << r.modulus;
    };
    near(m.rho, r.rho, 1);
    near(m.gain_up, r.gain_up, 1);
    near(m.gain_down, r.gain_down, 1);
    near(m.phase_deg, r.phase_deg, 60);
    near(m.delay_s, r.delay_s, 0.1);
    near(m.modulus, r.modulus, 1);
    near(m.disk_alpha, r.disk, 1);
  }
}

TEST(Margins, OfAWallOfNothingAreInfinite) {
  Loop loop;
  loop.plant.arm = models::nominal_arm(models::Axis::x);
  const Margins m = evaluate(loop);
  ASSERT_TRUE(m.stable);
  EXPECT_EQ(m.gain_up, Margins::kInfinity);
  EXPECT_EQ(m.gain_down, 0);
  EXPECT_EQ(m.phase_deg, Margins::kInfinity);
  EXPECT_EQ(m.delay_s, Margins::kInfinity);
  EXPECT_EQ(m.modulus, 1);
  EXPECT_EQ(m.disk_alpha, 2);
}

TEST(Margins, OfAFreeTipBeginWithItsIntegrator) {
  Loop loop;
  loop.gains = {20, 0.2};
  const Margins m = evaluate(loop);
  ASSERT_TRUE(m.stable);
  EXPECT_TRUE(std::isfinite(m.gain_up) && std::isfinite(m.phase_deg));
  loop.gains = {0, 0};
  EXPECT_FALSE(evaluate(loop).stable);  // nothing holds the tip: a pole at 1
}

TEST(Margins, OfAnUnstableLoopAreNotNumbers) {
  Loop loop;
  loop.plant.arm = models::nominal_arm(models::Axis::z);
  loop.gains = {5000, 0};
  const Margins m = evaluate(loop);
  EXPECT_FALSE(m.stable);
  EXPECT_GT(m.rho, 1);
  for (const double margin : {m.gain_up, m.gain_down, m.phase_deg, m.delay_s, m.modulus, m.disk_alpha})
    EXPECT_TRUE(std::isnan(margin));
}

/// Modes that coincide: two equal real poles, a device like the arm it holds, and everything undamped.
TEST(Margins, SurviveCoincidingModes) {
  for (const double b : {0.0, 1e-9, 0.05}) {
    for (const double k1 : {100.0, 400.0, 400.0000001}) {
      Loop loop;
      loop.plant = {0.2, b, models::ArmParameters{0.2, k1, 400, 4.0, 4.0}};
      loop.gains = {50, 0.5};
      const Margins m = evaluate(loop);
      EXPECT_TRUE(std::isfinite(m.rho));
      const auto plant = sample_plant(loop.plant, 1e-3);
      // at zero frequency the plant is its springs in series
      EXPECT_NEAR(plant(0.0).real(), 1 / k1 + 1 / 400.0, 1e-12);
    }
  }
}

TEST(Margins, RefuseWhatCannotBe) {
  Loop loop;
  loop.plant.tip_mass_kg = 0;
  EXPECT_THROW(evaluate(loop), InputError);
  loop = {};
  loop.timing.sample_time_s = -1;
  EXPECT_THROW(evaluate(loop), InputError);
  loop = {};
  loop.timing.delay_samples = 65;
  EXPECT_THROW(evaluate(loop), InputError);
  loop = {};
  loop.gains.stiffness_N_per_m = std::nan("");
  EXPECT_THROW(evaluate(loop), InputError);
}

}  // namespace
}  // namespace handloop::control
