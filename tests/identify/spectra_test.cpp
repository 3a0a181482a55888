#include "identify/spectra.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <random>

#include "identify/fourier.h"
#include "identify/local_polynomial.h"
#include "models/errors.h"

namespace handloop::identify {
namespace {

using Complex = std::complex<double>;

/// A sequence any language can repeat: linear congruential, -0.5 .. 0.5.
std::vector<double> congruential(std::uint32_t seed, std::size_t count) {
  std::vector<double> v(count);
  for (auto& x : v) {
    seed = seed * 1664525u + 1013904223u;
    x = seed / 4294967296.0 - 0.5;
  }
  return v;
}

struct Pair {
  std::vector<double> u, y;
};

/// A resonant filter driven by one sequence, another added to its output.
Pair resonant_pair() {
  constexpr std::size_t kCount = 20000;
  Pair p{congruential(1, kCount), std::vector<double>(kCount, 0.0)};
  for (std::size_t n = 2; n < kCount; ++n) p.y[n] = 1.9 * p.y[n - 1] - 0.93 * p.y[n - 2] + 0.01 * p.u[n - 1];
  const auto e = congruential(7, kCount);
  for (std::size_t n = 0; n < kCount; ++n) p.y[n] += 0.02 * e[n];
  return p;
}

Complex resonant_response(double frequency_Hz) {
  const Complex z = std::polar(1.0, 2 * std::numbers::pi * frequency_Hz * 0.001);
  return 0.01 * z / (z * z - 1.9 * z + 0.93);
}

TEST(Fourier, AgreesWithTheDefiningSumAtLengthsWithLargePrimes) {
  for (const std::size_t length : {1u, 2u, 58u, 66u, 97u, 1914u}) {
    const auto x = congruential(3, length);
    auto y = congruential(4, length);
    for (auto& v : y) v *= 1e-4;
    std::vector<Complex> X(length / 2 + 1), Y(X.size());
    PairTransform{length}(x, y, X, Y);
    for (std::size_t k = 0; k < X.size(); k += 1 + k / 4) {
      Complex sx = 0, sy = 0;
      for (std::size_t n = 0; n < length; ++n) {
        const Complex e = std::polar(
            1.0, -2 * std::numbers::pi * static_cast<double>((k * n) % length) / static_cast<double>(length));
        sx += x[n] * e;
        sy += y[n] * e;
      }
      EXPECT_LT(std::abs(X[k] - sx), 1e-11) << length << " " << k;         // residual 2e-13
      EXPECT_LT(std::abs(Y[k] - sy), 1e-15 * 1914) << length << " " << k;  // residual 2e-17: the smaller is not drowned
    }
  }
}

TEST(Fourier, AFewBinsAreThoseOfTheWholeTransform) {
  for (const std::size_t length : {6u, 64u, 1914u, 60000u, 7919u}) {
    const auto x = congruential(5, length), y = congruential(6, length);
    std::vector<Complex> X(length / 2 + 1), Y(X.size());
    PairTransform{length}(x, y, X, Y);
    for (const std::size_t bins : {std::size_t{1}, std::size_t{3}, length / 33 + 1}) {
      std::vector<Complex> few_X(bins), few_Y(bins);
      PairTransform{length, bins}(x, y, few_X, few_Y);
      for (std::size_t k = 0; k < bins; ++k) {
        EXPECT_LT(std::abs(few_X[k] - X[k]), 1e-9) << length << " " << bins << " " << k;  // residual 3e-12
        EXPECT_LT(std::abs(few_Y[k] - Y[k]), 1e-9);
      }
    }
  }
}

TEST(Fourier, SmoothLengthHasOnlySmallPrimesAndIsTheLargest) {
  EXPECT_EQ(smooth_length(60000), 60000u);
  EXPECT_EQ(smooth_length(59999), 59049u);  // 3^10
  EXPECT_EQ(smooth_length(7), 6u);
  EXPECT_EQ(smooth_length(1), 1u);
  EXPECT_EQ(smooth_length(0), 0u);
}

TEST(Windows, AreTheTextbookOnes) {
  const auto hamming = make_window(Window::hamming, 1914, true);
  EXPECT_NEAR(hamming.front(), 0.08, 1e-15);
  EXPECT_NEAR(hamming.back(), 0.08, 1e-15);
  const auto hann = make_window(Window::hann, 8, false);
  EXPECT_NEAR(hann[0], 0, 1e-15);
  EXPECT_NEAR(hann[4], 1, 1e-15);
}

TEST(Welch, PaperSettingsKeepTheirDurationAtAnyRate) {
  const auto s = paper_settings(0.001);
  EXPECT_EQ(s.segment, 1914u);
  EXPECT_EQ(s.overlap, 957u);
  EXPECT_EQ(s.first_bin, 1u);
  EXPECT_EQ(s.last_bin, 57u);
  EXPECT_EQ(paper_settings(0.0005).segment, 3828u);
  const std::vector<double> u(60000, 0.0);
  const auto spectra = welch(u, u, 0.001, s);
  EXPECT_EQ(spectra.segments, 61u);
  EXPECT_NEAR(spectra.frequency_Hz.front(), 0.5224660, 1e-6);
  EXPECT_NEAR(spectra.frequency_Hz.back(), 29.780564, 1e-6);
}

// Expected values: scipy.signal.csd, welch and coherence (SciPy 1.10) of the same sequences.
TEST(Welch, PaperSettingsAgreeWithScipy) {
  const auto p = resonant_pair();
  const auto s = welch(p.u, p.y, 0.001, paper_settings(0.001));
  const auto h = frequency_response(s);
  ASSERT_EQ(h.size(), 57u);
  struct Row {
    std::size_t bin;
    double re, im, coherence, input, output;
  };
  for (const Row& row : {Row{1, 0.33333835000687423, -0.00560444989711658, 0.9963832066397282, 0.00017603468470867053,
                             1.963654871912487e-05},
                         Row{2, 0.3277630339807652, -0.0034972674775264577, 0.9982457145691448, 0.00023065164173432972,
                             2.482495557599999e-05},
                         Row{20, 0.371600795911372, -0.0703365457576311, 0.997641963865985, 0.000199491970600522,
                             2.8601654301771068e-05},
                         Row{57, -0.2024202172599826, -0.7071981012146542, 0.9960542588251069, 0.00015759852632967896,
                             8.56148650484567e-05}}) {
    const std::size_t b = row.bin - 1;
    EXPECT_NEAR(h.response[b].real(), row.re, 1e-12);  // residual 1e-15
    EXPECT_NEAR(h.response[b].imag(), row.im, 1e-12);
    EXPECT_NEAR(h.coherence[b], row.coherence, 1e-12);
    EXPECT_NEAR(s.input_power[b] / row.input, 1, 1e-12);
    EXPECT_NEAR(s.output_power[b] / row.output, 1, 1e-12);
  }
}

TEST(Welch, PeriodicHannWithSegmentMeansAgreesWithScipyUpToHalfTheRate) {
  const auto p = resonant_pair();
  WelchSettings settings;
  settings.segment = 4096;
  settings.overlap = 2048;
  settings.first_bin = 0;
  const auto s = welch(p.u, p.y, 0.001, settings);
  const auto h = frequency_response(s);
  ASSERT_EQ(h.size(), 2049u);
  EXPECT_NEAR(std::abs(h.response[100] - Complex(0.4311140284049355, -0.6422556276379273)), 0, 1e-12);
  EXPECT_NEAR(h.coherence[100], 0.9994302038703831, 1e-12);
  EXPECT_NEAR(s.input_power[100] / 0.00027336024219265986, 1, 1e-12);
  EXPECT_NEAR(std::abs(h.response[2048] - Complex(-0.0014481419048690443, 0)), 0, 1e-12);
  EXPECT_NEAR(s.input_power[2048] / 0.00019360409838312665, 1, 1e-12);  // one-sided: the last bin counts once
}

TEST(Welch, VarianceIsTheScatterOfRepeatedEstimates) {
  // 200 repetitions of white noise through a gain of 1 with noise of the same size: coherence 1/2.
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  double predicted = 0, scatter = 0;
  std::size_t count = 0;
  for (int repetition = 0; repetition < 200; ++repetition) {
    std::vector<double> u(8000), y(8000);
    for (std::size_t n = 0; n < u.size(); ++n) {
      u[n] = normal(random);
      y[n] = u[n] + normal(random);
    }
    WelchSettings settings;
    settings.segment = 500;
    settings.overlap = 250;
    const auto h = frequency_response(welch(u, y, 0.001, settings));
    for (std::size_t b = 5; b < 240; b += 5, ++count) {
      predicted += h.variance[b];
      scatter += std::norm(h.response[b] - 1.0);
    }
  }
  EXPECT_NEAR(predicted / scatter, 1, 0.1);  // ratio 0.99
}

TEST(Welch, CoherenceOfUnrelatedSignalsIsOneOverTheAverages) {
  const auto u = congruential(11, 200000), y = congruential(12, 200000);
  WelchSettings settings;
  settings.segment = 1000;
  settings.overlap = 500;
  const auto s = welch(u, y, 0.001, settings);
  const auto c = coherence(s);
  double mean = 0;
  for (std::size_t b = 1; b + 1 < c.size(); ++b) mean += c[b];
  mean /= static_cast<double>(c.size() - 2);
  EXPECT_NEAR(mean * s.averages, 1, 0.1);  // 0.98
}

TEST(Welch, RefusesWhatItCannotAverage) {
  const std::vector<double> u(1000, 1.0), shorter(999, 1.0);
  auto broken = u;
  broken[41] = std::numeric_limits<double>::quiet_NaN();
  WelchSettings settings;
  settings.segment = 500;
  settings.overlap = 250;
  EXPECT_THROW(welch(u, shorter, 0.001, settings), InputError);
  EXPECT_THROW(welch(u, u, 0.001, paper_settings(0.001)), InputError);
  try {
    welch(u, broken, 0.001, settings);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("42"), std::string::npos);  // says which sample
  }
  settings.overlap = 500;
  EXPECT_THROW(welch(u, u, 0.001, settings), InputError);
}

TEST(LocalPolynomial, HasFarLessLeakageThanSegmentsOfTheSameRecord) {
  // A lightly damped filter and a short record without noise: what is wrong is leakage alone.
  const auto u = congruential(21, 6000);
  std::vector<double> y(u.size(), 0.0);
  for (std::size_t n = 2; n < u.size(); ++n) y[n] = 1.9 * y[n - 1] - 0.93 * y[n - 2] + 0.01 * u[n - 1];
  auto worst = [](const FrequencyResponse& h) {
    double error = 0;
    for (std::size_t b = 0; b < h.size(); ++b) {
      const Complex truth = resonant_response(h.frequency_Hz[b]);
      error = std::max(error, std::abs(h.response[b] - truth) / std::abs(truth));
    }
    return error;
  };
  LocalPolynomialSettings settings;
  settings.half_width = 6;
  settings.lowest_Hz = 2;
  settings.highest_Hz = 100;
  const double local = worst(local_polynomial_response(u, y, 0.001, settings));
  WelchSettings segments;
  segments.segment = 1024;
  segments.overlap = 512;
  segments.first_bin = 2;
  segments.last_bin = 100;
  EXPECT_LT(local, 2e-3);
  EXPECT_GT(worst(frequency_response(welch(u, y, 0.001, segments))), 10 * local);
}

TEST(LocalPolynomial, NoiseMakesItsErrorsAsLargeAsItSays) {
  const auto p = resonant_pair();
  LocalPolynomialSettings settings;
  settings.lowest_Hz = 5;
  settings.highest_Hz = 90;
  const auto h = local_polynomial_response(p.u, p.y, 0.001, settings);
  double ratio = 0;
  for (std::size_t b = 0; b < h.size(); ++b) {
    ratio += std::norm(h.response[b] - resonant_response(h.frequency_Hz[b])) / h.variance[b];
  }
  EXPECT_NEAR(ratio / static_cast<double>(h.size()), 1, 0.25);
}

TEST(LocalPolynomial, AnswersAtGivenFrequenciesAndRefusesShortRecords) {
  const auto p = resonant_pair();
  const std::vector<double> wanted{1.0, 10.45, 29.8};
  const auto h = local_polynomial_response(p.u, p.y, 0.001, {}, wanted);
  ASSERT_EQ(h.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(h.frequency_Hz[i], wanted[i], 0.026);  // half a line of 20 s
    EXPECT_LT(std::abs(h.response[i] - resonant_response(h.frequency_Hz[i])), 0.02);
  }
  const std::vector<double> three{1, 2, 3};
  EXPECT_THROW(local_polynomial_response(three, three, 0.001, {}), InputError);
}

}  // namespace
}  // namespace handloop::identify
