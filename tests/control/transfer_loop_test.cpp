#include "control/transfer_loop.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "models/errors.h"

/// Loops whose margins are known from books, papers or a line of algebra.
namespace handloop::control {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kInfinity = Margins::kInfinity;

Margins continuous(std::vector<double> num, std::vector<double> den, double delay = 0) {
  return evaluate(TransferLoop{std::move(num), std::move(den), {}, delay}).margins;
}
Margins discrete(std::vector<double> num, std::vector<double> den, double T = 1) {
  return evaluate(TransferLoop{std::move(num), std::move(den), T, 0}).margins;
}

TEST(TransferLoop, SeilerPackardAndGahinetsExample) {
  // "An introduction to disk margins", IEEE Control Systems 40(5), 2020: L = 25/(s^3 + 10 s^2 + 10 s + 10)
  const Margins m = continuous({25}, {1, 10, 10, 10});
  ASSERT_TRUE(m.stable);
  EXPECT_NEAR(m.disk_alpha, 0.45809, 5e-6);
  EXPECT_NEAR(m.disk_at_rad_per_s, 1.955, 5e-4);
  EXPECT_NEAR(m.gain_up, 3.6, 1e-9);  // Routh: 100 > 10 + 25 k
  EXPECT_NEAR(m.gain_up_at_rad_per_s, std::sqrt(10), 1e-7);
  EXPECT_NEAR(m.phase_deg, 29.1, 0.05);  // as printed there
  const auto disk = disk_guarantee(m.disk_alpha);
  EXPECT_NEAR(disk.gain_low, 0.6273, 5e-5);
  EXPECT_NEAR(disk.gain_high, 1.5942, 5e-5);
  EXPECT_NEAR(disk.phase_deg, 25.80, 5e-3);
}

TEST(TransferLoop, DiskGuaranteesAreThoseOfMatlabsDm2gm) {
  struct Row {
    double alpha, skew, low, high, phase;
  };
  for (const Row& r :
       {Row{0.5, 0, 1 / 1.6667, 1.6667, 28.0725}, Row{0.6, 0.75, 0.6066, 2.2632, 34.2267},
        Row{0.75, -0.5, 0.3684, 1.9231, 41.7908}, Row{0.75, 0, 0.4545, 2.2, NAN}, Row{0.75, 0.5, 0.52, 2.7143, NAN}}) {
    const auto g = disk_guarantee(r.alpha, r.skew);
    EXPECT_NEAR(g.gain_low, r.low, 5e-5);
    EXPECT_NEAR(g.gain_high, r.high, 5e-5);
    if (!std::isnan(r.phase)) {
      EXPECT_NEAR(g.phase_deg, r.phase, 5e-5);
    }
  }
}

TEST(TransferLoop, AnUnstableLoopHasNoMargins) {
  // L = -2/(s + 1) has a closed-loop pole at +1, though its Nyquist plot keeps a distance from -1 that reads as 6 dB
  const Margins m = continuous({-2}, {1, 1});
  EXPECT_FALSE(m.stable);
  for (const double margin : {m.gain_up, m.gain_down, m.phase_deg, m.delay_s, m.modulus, m.disk_alpha})
    EXPECT_TRUE(std::isnan(margin));
}

TEST(TransferLoop, AConditionallyStableLoopIsLostWhenItsGainFalls) {
  // s^3 + k (s + 2)^2: stable for k > 1
  const Margins m = continuous({4, 16, 16}, {1, 0, 0, 0});
  ASSERT_TRUE(m.stable);
  EXPECT_NEAR(m.gain_down, 0.25, 1e-9);
  EXPECT_EQ(m.gain_up, kInfinity);
  EXPECT_FALSE(continuous({0.9, 3.6, 3.6}, {1, 0, 0, 0}).stable);
}

TEST(TransferLoop, ANonMinimumPhaseLoopIsLostWhenItsGainRises) {
  // k (1 - s)/(s (1 + s)): stable for 0 < k < 1, ringing at 1 rad/s at the limit
  const Margins m = continuous({-0.5, 0.5}, {1, 1, 0});
  ASSERT_TRUE(m.stable);
  EXPECT_NEAR(m.gain_up, 2, 1e-9);
  EXPECT_NEAR(m.gain_up_at_rad_per_s, 1, 1e-8);
  EXPECT_EQ(m.gain_down, 0);
}

TEST(TransferLoop, ABiproperLoopMayBeLostAtInfiniteFrequency) {
  // 0.5 (1 - s)/(1 + s): 1 + k L(infinity) = 0 at k = 2
  const Margins m = continuous({-0.5, 0.5}, {1, 1});
  ASSERT_TRUE(m.stable);
  EXPECT_NEAR(m.gain_up, 2, 1e-12);
  EXPECT_EQ(m.gain_up_at_rad_per_s, kInfinity);
  EXPECT_NEAR(m.modulus, 0.5, 1e-12);
  EXPECT_NEAR(m.disk_alpha, 2.0 / 3, 1e-12);
  // and where the leading powers cancel outright there is no closed loop to speak of
  EXPECT_FALSE(continuous({-1, 0.5}, {1, 1}).stable);
}

TEST(TransferLoop, AnImproperLoopToleratesNoDelay) {
  const Margins m = continuous({1, 1, 1}, {1, 3});
  ASSERT_TRUE(m.stable);
  EXPECT_EQ(m.delay_s, 0);
  EXPECT_FALSE(continuous({1, 1, 1}, {1, 3}, 1e-6).stable);
  EXPECT_THROW(discrete({1, 1, 1}, {1, 3}), InputError);  // needs the future
}

TEST(TransferLoop, ManyCrossoversGiveTheSmallestPhase) {
  // an integrator with three sharp modes: |L| = 1 seven times
  std::vector<double> num{0.3}, den{1, 0};
  const auto times = [](const std::vector<double>& a, const std::vector<double>& b) {
    std::vector<double> p(a.size() + b.size() - 1, 0.0);
    for (std::size_t i = 0; i < a.size(); ++i) {
      for (std::size_t k = 0; k < b.size(); ++k) p[i + k] += a[i] * b[k];
    }
    return p;
  };
  for (const double w : {1.0, 3.0, 9.0}) {
    den = times(den, {1 / (w * w), 2 * 0.002 / w, 1});
    num = times(num,
                {1 / (0.9 * w * 0.9 * w), 2 * 0.002 / (0.9 * w), 1});  // zeros before poles keep the phase within -180
  }
  const Margins m = continuous(num, den);
  const TransferLoop loop{num, den, {}, 0};
  // brute force on four million points
  double smallest = 1e9;
  int crossings = 0;
  std::complex<double> last = loop(0.1);
  for (int i = 1; i <= 4'000'000; ++i) {
    const auto L = loop(0.1 * std::pow(1000.0, i / 4e6));
    if ((std::abs(L) > 1) != (std::abs(last) > 1))
      ++crossings, smallest = std::min(smallest, std::abs(std::arg(-L)) * 180 / kPi);
    last = L;
  }
  ASSERT_TRUE(m.stable);
  EXPECT_EQ(crossings, 7);
  EXPECT_NEAR(std::abs(m.phase_deg), smallest, 0.05);  // the grid's own error at a sharp mode
}

TEST(TransferLoop, PureDelaysOfADiscreteLoop) {
  // 0.5 z^-3
  const Margins m = discrete({0.5}, {1, 0, 0, 0});
  ASSERT_TRUE(m.stable);
  EXPECT_NEAR(m.rho, std::cbrt(0.5), 1e-14);
  EXPECT_NEAR(m.gain_up, 2, 1e-12);
  EXPECT_EQ(m.phase_deg, kInfinity);
  EXPECT_EQ(m.delay_s, kInfinity);
  EXPECT_NEAR(m.modulus, 0.5, 1e-12);
  EXPECT_NEAR(m.disk_alpha, 2.0 / 3, 1e-12);
  EXPECT_FALSE(discrete({1}, {1, 0, 0, 0}).stable);  // poles on the circle
}

TEST(TransferLoop, AnAccumulator) {
  // 1/(z - 1), T = 0.01: |L| = 1 at 60 degrees where L = e^{-j 120 deg}; at Nyquist L = -1/2
  const Margins m = discrete({1}, {1, -1}, 0.01);
  ASSERT_TRUE(m.stable);
  EXPECT_NEAR(m.phase_deg, 60, 1e-10);
  EXPECT_NEAR(m.delay_s, 0.01, 1e-13);
  EXPECT_NEAR(m.gain_up, 2, 1e-12);
  EXPECT_NEAR(m.gain_up_at_rad_per_s, kPi / 0.01, 1e-9);
  EXPECT_NEAR(m.modulus, 0.5, 1e-12);
}

TEST(TransferLoop, DeadTimeOfAnIntegrator) {
  // e^{-s tau}/s: stable for tau < pi/2, whatever else
  const Margins free = continuous({1}, {1, 0});
  EXPECT_NEAR(free.delay_s, kPi / 2, 1e-10);
  const Margins late = continuous({1}, {1, 0}, 1.0);
  ASSERT_TRUE(late.stable);
  EXPECT_NEAR(late.delay_s, kPi / 2 - 1, 1e-10);
  EXPECT_NEAR(late.gain_up, kPi / 2, 1e-9);
  EXPECT_TRUE(continuous({1}, {1, 0}, 1.57079).stable);
  EXPECT_FALSE(continuous({1}, {1, 0}, 1.57080).stable);
}

TEST(TransferLoop, DeadTimeMayStabiliseAgain) {
  // s^2 + 0.2 s + 1 + 0.5 e^{-s tau}: crossings at |0.5| = |1 - w^2 + 0.2 j w|; between them stability comes and goes,
  // as the time domain shows (Cooke and van den Driessche 1986): w = 1.1968 falls out, 0.6988 comes back in
  std::vector<bool> verdicts;
  for (const double tau : {0.1, 1.5, 5.0}) {
    const bool stable = continuous({0.5}, {1, 0.2, 1}, tau).stable;
    // simulate by small steps
    const double h = 5e-4;
    const auto lag = static_cast<std::size_t>(tau / h);
    std::vector<double> x(lag + 1, 1e-3);
    double v = 0, before = 0, after = 0;
    const std::size_t steps = 800'000;
    for (std::size_t i = 0; i < steps; ++i) {
      v += h * (-0.2 * v - x.back() - 0.5 * x[x.size() - 1 - lag]);
      x.push_back(x.back() + h * v);
      if (i > steps / 4 && i < steps / 2) before = std::max(before, std::abs(x.back()));
      if (i > 3 * steps / 4) after = std::max(after, std::abs(x.back()));
    }
    EXPECT_EQ(stable, after < before) << tau;
    verdicts.push_back(stable);
  }
  EXPECT_TRUE(verdicts[0]);
  EXPECT_FALSE(verdicts[1]);
}

TEST(TransferLoop, NearCancellationsChangeNothingUnlessTheyHideInstability) {
  const Margins plain = continuous({1}, {1, 2, 0});
  const Margins near = continuous({1, 1.000001}, {1, 3, 2, 0});  // (s + 1.000001)/((s + 1)(s + 2) s)
  EXPECT_NEAR(near.phase_deg, plain.phase_deg, 1e-4);
  EXPECT_NEAR(near.disk_alpha, plain.disk_alpha, 1e-5);
  EXPECT_FALSE(continuous({1, -1}, {1, 1, -2}).stable);  // (s - 1)/((s - 1)(s + 2))
}

TEST(TransferLoop, AZeroLoopIsAsStableAsItsPlant) {
  const Margins m = continuous({0}, {1, 1});
  ASSERT_TRUE(m.stable);
  EXPECT_EQ(m.gain_up, kInfinity);
  EXPECT_EQ(m.phase_deg, kInfinity);
  EXPECT_EQ(m.modulus, 1);
  EXPECT_EQ(m.disk_alpha, 2);
  EXPECT_FALSE(continuous({0}, {1, 0}).stable);
  EXPECT_FALSE(continuous({0}, {1, 0, 1}).stable);  // an undamped oscillator
}

TEST(TransferLoop, RefusesWhatIsNoLoop) {
  EXPECT_THROW(continuous({}, {1, 1}), InputError);
  EXPECT_THROW(continuous({1}, {0, 0}), InputError);
  EXPECT_THROW(continuous({1}, {1, std::nan("")}), InputError);
  EXPECT_THROW(discrete({1}, {1, 1}, -1), InputError);
  EXPECT_THROW(continuous({1}, {1, 1}, -0.1), InputError);
}

TEST(TransferLoop, RootsOfBadlyScaledPolynomialsKeepTheirDigits) {
  // (s + 1e-3)(s + 1)(s + 1e3)(s + 1e6)
  const auto roots = polynomial_roots(
      {1, 1001001.001, 1001001001.0 + 1000 + 1, 1001001001.0 + 1e6 * 1e-3 - 1000 + 1e3 - 1e0 + 0, 1e6});
  for (const auto& r : roots) EXPECT_LT(r.real(), 0);
  // Wilkinson's ten: coefficients are exact in double
  const auto wilkinson =
      polynomial_roots({1, -55, 1320, -18150, 157773, -902055, 3416930, -8409500, 12753576, -10628640, 3628800});
  double sum = 0;
  for (const auto& r : wilkinson) {
    EXPECT_NEAR(r.real(), std::round(r.real()), 1e-8);
    sum += r.real();
  }
  EXPECT_NEAR(sum, 55, 1e-9);
}

}  // namespace
}  // namespace handloop::control
