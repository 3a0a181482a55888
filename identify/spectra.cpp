#include "identify/spectra.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "identify/fourier.h"
#include "models/errors.h"

namespace handloop::identify {

using Complex = std::complex<double>;

namespace {

/// Duration of the paper's segments: 57 bins reach 30 Hz.
constexpr double kPaperSegment_s = 1.914;
constexpr std::size_t kPaperBins = 57;

void require_finite(std::span<const double> signal, const char* which) {
  for (std::size_t n = 0; n < signal.size(); ++n) {
    if (!std::isfinite(signal[n])) {
      throw InputError(fmt::format("{} has no finite value at sample {}; spectra need every sample", which, n + 1));
    }
  }
}

double mean_of(std::span<const double> signal) {
  return std::accumulate(signal.begin(), signal.end(), 0.0) / static_cast<double>(signal.size());
}

/// Welch's count of independent averages: K / (1 + 2 sum (1 - m/K) rho(m)), rho(m) the squared normalised correlation
/// of the window with itself m hops later.
double independent_averages(const std::vector<double>& window, std::size_t segments, std::size_t hop) {
  double power = 0;
  for (const double w : window) power += w * w;
  double sum = 1;
  for (std::size_t m = 1; m < segments && m * hop < window.size(); ++m) {
    double overlap = 0;
    for (std::size_t n = m * hop; n < window.size(); ++n) overlap += window[n] * window[n - m * hop];
    const double rho = overlap / power;
    sum += 2 * (1 - static_cast<double>(m) / static_cast<double>(segments)) * rho * rho;
  }
  return static_cast<double>(segments) / sum;
}

}  // namespace

std::vector<double> make_window(Window window, std::size_t length, bool symmetric) {
  std::vector<double> w(length, 1.0);
  if (window == Window::rectangular || length < 2) return w;
  const double base = window == Window::hann ? 0.5 : 0.54;
  const double period = static_cast<double>(symmetric ? length - 1 : length);
  for (std::size_t n = 0; n < length; ++n) {
    w[n] = base - (1 - base) * std::cos(2 * std::numbers::pi * static_cast<double>(n) / period);
  }
  return w;
}

WelchSettings paper_settings(double sample_time_s) {
  WelchSettings s;
  s.segment = 2 * static_cast<std::size_t>(std::lround(kPaperSegment_s / sample_time_s / 2));
  s.overlap = s.segment / 2;
  s.window = Window::hamming;
  s.symmetric = true;
  s.mean = MeanRemoval::record;
  s.first_bin = 1;
  s.last_bin = std::min(kPaperBins, s.segment / 2);
  return s;
}

WelchSettings long_segment_settings(std::size_t samples, double sample_time_s, double highest_Hz) {
  WelchSettings s;
  const double wanted = 8.192 / sample_time_s;
  s.segment = std::size_t{1} << static_cast<unsigned>(std::max(3L, std::lround(std::log2(wanted))));
  while (s.segment > 8 && 4 * s.segment > samples) s.segment /= 2;
  s.overlap = s.segment / 2;
  const double bins = std::floor(highest_Hz * sample_time_s * static_cast<double>(s.segment));
  s.last_bin = std::clamp<std::size_t>(static_cast<std::size_t>(bins), 1, s.segment / 2);
  return s;
}

Spectra welch(std::span<const double> u, std::span<const double> y, double sample_time_s,
              const WelchSettings& settings) {
  const std::size_t length = settings.segment;
  if (u.size() != y.size()) {
    throw InputError(fmt::format("input has {} samples and output {}; both need the same number", u.size(), y.size()));
  }
  if (length < 2 || settings.overlap >= length) {
    throw InputError(fmt::format("segments of {} samples overlapping by {} cannot be; the overlap must be the smaller",
                                 length, settings.overlap));
  }
  if (u.size() < length) {
    throw InputError(fmt::format("{} samples are too few for one segment of {} ({:.3g} s)", u.size(), length,
                                 static_cast<double>(length) * sample_time_s));
  }
  require_finite(u, "the input");
  require_finite(y, "the output");

  const std::size_t last = settings.last_bin == 0 ? length / 2 : std::min(settings.last_bin, length / 2);
  const std::size_t first = std::min(settings.first_bin, last);
  const std::size_t hop = length - settings.overlap;
  const auto window = make_window(settings.window, length, settings.symmetric);
  const bool by_record = settings.mean == MeanRemoval::record;
  const double record_u = by_record ? mean_of(u) : 0.0, record_y = by_record ? mean_of(y) : 0.0;

  Spectra out;
  const std::size_t bins = last - first + 1;
  out.segments = 1 + (u.size() - length) / hop;
  out.averages = independent_averages(window, out.segments, hop);
  out.frequency_Hz.resize(bins);
  out.input_power.assign(bins, 0.0);
  out.output_power.assign(bins, 0.0);
  out.cross_power.assign(bins, Complex(0));

  PairTransform transform(length, last + 1);
  std::vector<double> wu(length), wy(length);
  std::vector<Complex> U(last + 1), Y(last + 1);
  for (std::size_t segment = 0; segment < out.segments; ++segment) {
    const auto su = u.subspan(segment * hop, length), sy = y.subspan(segment * hop, length);
    const bool by_segment = settings.mean == MeanRemoval::segment;
    const double mean_u = by_segment ? mean_of(su) : record_u, mean_y = by_segment ? mean_of(sy) : record_y;
    for (std::size_t n = 0; n < length; ++n) {
      wu[n] = window[n] * (su[n] - mean_u);
      wy[n] = window[n] * (sy[n] - mean_y);
    }
    transform(wu, wy, U, Y);
    for (std::size_t b = 0; b < bins; ++b) {
      out.input_power[b] += std::norm(U[first + b]);
      out.output_power[b] += std::norm(Y[first + b]);
      out.cross_power[b] += std::conj(U[first + b]) * Y[first + b];
    }
  }

  double window_power = 0;
  for (const double w : window) window_power += w * w;
  for (std::size_t b = 0; b < bins; ++b) {
    const std::size_t k = first + b;
    out.frequency_Hz[b] = static_cast<double>(k) / (static_cast<double>(length) * sample_time_s);
    // One-sided: every bin but zero and the last stands for its mirror image too.
    const double sides = (k == 0 || 2 * k == length) ? 1.0 : 2.0;
    const double scale = sides * sample_time_s / (window_power * static_cast<double>(out.segments));
    out.input_power[b] *= scale;
    out.output_power[b] *= scale;
    out.cross_power[b] *= scale;
  }
  return out;
}

std::vector<double> coherence(const Spectra& spectra) {
  std::vector<double> c(spectra.frequency_Hz.size(), 0.0);
  for (std::size_t b = 0; b < c.size(); ++b) {
    const double powers = spectra.input_power[b] * spectra.output_power[b];
    if (powers > 0) c[b] = std::min(1.0, std::norm(spectra.cross_power[b]) / powers);
  }
  return c;
}

FrequencyResponse frequency_response(const Spectra& spectra) {
  FrequencyResponse out;
  out.frequency_Hz = spectra.frequency_Hz;
  out.coherence = coherence(spectra);
  out.response.resize(out.size());
  out.variance.resize(out.size());
  for (std::size_t b = 0; b < out.size(); ++b) {
    const double power = spectra.input_power[b], c = out.coherence[b];
    if (power > 0) out.response[b] = spectra.cross_power[b] / power;
    out.variance[b] =
        c > 0 ? (1 - c) / c * std::norm(out.response[b]) / spectra.averages : std::numeric_limits<double>::infinity();
  }
  return out;
}

}  // namespace handloop::identify
