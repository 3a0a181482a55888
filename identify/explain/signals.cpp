#include "identify/explain/signals.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

#include "identify/explain/discretise.h"

namespace handloop::identify {
namespace {

/// One second-order section by the bilinear transform with prewarping.
struct Section {
  std::array<double, 3> b{};
  std::array<double, 2> a{};  // a1, a2

  void run(std::vector<double>& signal, double settled_at) const {
    // state that holds still under the constant input `settled_at`
    const double gain = (b[0] + b[1] + b[2]) / (1 + a[0] + a[1]);
    const double out = gain * settled_at;
    double s1 = out - b[0] * settled_at;
    double s2 = b[2] * settled_at - a[1] * out;
    for (double& u : signal) {
      const double y = b[0] * u + s1;
      s1 = b[1] * u - a[0] * y + s2;
      s2 = b[2] * u - a[1] * y;
      u = y;
    }
  }
};

Section butterworth_section(double cutoff_Hz, double sample_time_s, double q, bool high_pass) {
  const double k = std::tan(std::numbers::pi * std::min(cutoff_Hz * sample_time_s, 0.49));
  const double norm = 1 / (1 + k / q + k * k);
  Section section;
  section.b = high_pass ? std::array{norm, -2 * norm, norm} : std::array{k * k * norm, 2 * k * k * norm, k * k * norm};
  section.a = {2 * (k * k - 1) * norm, (1 - k / q + k * k) * norm};
  return section;
}

}  // namespace

std::vector<double> delayed(std::span<const double> signal, double delay_s, double sample_time_s) {
  const auto n = static_cast<std::ptrdiff_t>(signal.size());
  std::vector<double> out(signal.size());
  const double shift = delay_s / sample_time_s;
  const auto whole = static_cast<std::ptrdiff_t>(std::floor(shift));
  const double w = 1 - (shift - static_cast<double>(whole));  // position between samples i-whole-1 and i-whole
  // Lagrange through the samples at -1, 0, 1, 2
  const std::array<double, 4> weight{-w * (w - 1) * (w - 2) / 6, (w + 1) * (w - 1) * (w - 2) / 2,
                                     -(w + 1) * w * (w - 2) / 2, (w + 1) * w * (w - 1) / 6};
  for (std::ptrdiff_t i = 0; i < n; ++i) {
    double value = 0;
    for (std::ptrdiff_t k = 0; k < 4; ++k)
      value += weight[k] * signal[std::clamp<std::ptrdiff_t>(i - whole - 2 + k, 0, n - 1)];
    out[i] = value;
  }
  return out;
}

std::vector<double> lagged(std::span<const double> signal, double time_constant_s, double sample_time_s) {
  std::vector<double> out(signal.begin(), signal.end());
  if (time_constant_s <= 0 || out.empty()) return out;
  const auto step = discretise_decay(1 / time_constant_s, 1 / time_constant_s, sample_time_s);
  double y = signal[0];
  for (std::size_t i = 1; i < out.size(); ++i) {
    y = step.transition * y + step.at_start * signal[i - 1] + step.at_end * signal[i];
    out[i] = y;
  }
  return out;
}

std::vector<double> high_passed(std::span<const double> signal, double cutoff_Hz, double sample_time_s) {
  std::vector<double> out(signal.begin(), signal.end());
  if (cutoff_Hz <= 0 || out.empty()) return out;
  butterworth_section(cutoff_Hz, sample_time_s, 1 / std::numbers::sqrt2, true).run(out, out.front());
  return out;
}

std::vector<double> decimated(std::span<const double> signal, std::size_t factor) {
  std::vector<double> out(signal.size() / factor);
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = mean(signal.subspan(i * factor, factor));
  return out;
}

std::vector<double> smoothed(std::span<const double> signal, double cutoff_Hz, double sample_time_s) {
  if (signal.size() < 4) return {signal.begin(), signal.end()};
  // odd mirror at both ends, long enough for the filter to settle
  const auto pad = std::min(signal.size() - 1, static_cast<std::size_t>(2.0 / (cutoff_Hz * sample_time_s)) + 10);
  std::vector<double> padded;
  padded.reserve(signal.size() + 2 * pad);
  for (std::size_t i = pad; i > 0; --i) padded.push_back(2 * signal.front() - signal[i]);
  padded.insert(padded.end(), signal.begin(), signal.end());
  for (std::size_t i = 1; i <= pad; ++i) padded.push_back(2 * signal.back() - signal[signal.size() - 1 - i]);
  const std::array sections{butterworth_section(cutoff_Hz, sample_time_s, 0.541196100146197, false),
                            butterworth_section(cutoff_Hz, sample_time_s, 1.306562964876377, false)};
  for (int direction = 0; direction < 2; ++direction) {
    for (const auto& section : sections) section.run(padded, padded.front());
    std::reverse(padded.begin(), padded.end());
  }
  return {padded.begin() + static_cast<std::ptrdiff_t>(pad),
          padded.begin() + static_cast<std::ptrdiff_t>(pad + signal.size())};
}

std::vector<double> derivative(std::span<const double> x, double sample_time_s) {
  const std::size_t n = x.size();
  std::vector<double> out(n, 0.0);
  if (n < 5) return out;
  for (std::size_t i = 2; i + 2 < n; ++i)
    out[i] = (x[i - 2] - 8 * x[i - 1] + 8 * x[i + 1] - x[i + 2]) / (12 * sample_time_s);
  out[1] = (x[2] - x[0]) / (2 * sample_time_s);
  out[n - 2] = (x[n - 1] - x[n - 3]) / (2 * sample_time_s);
  out[0] = (-3 * x[0] + 4 * x[1] - x[2]) / (2 * sample_time_s);
  out[n - 1] = (3 * x[n - 1] - 4 * x[n - 2] + x[n - 3]) / (2 * sample_time_s);
  return out;
}

double rms(std::span<const double> signal) {
  double sum = 0;
  for (const double value : signal) sum += value * value;
  return signal.empty() ? 0.0 : std::sqrt(sum / static_cast<double>(signal.size()));
}

double mean(std::span<const double> signal) {
  return signal.empty() ? 0.0 : std::accumulate(signal.begin(), signal.end(), 0.0) / static_cast<double>(signal.size());
}

double standard_deviation(std::span<const double> signal) {
  const double centre = mean(signal);
  double sum = 0;
  for (const double value : signal) sum += (value - centre) * (value - centre);
  return signal.empty() ? 0.0 : std::sqrt(sum / static_cast<double>(signal.size()));
}

double correlation(std::span<const double> a, std::span<const double> b) {
  const double mean_a = mean(a), mean_b = mean(b), scale = standard_deviation(a) * standard_deviation(b);
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - mean_a) * (b[i] - mean_b);
  return scale > 0 ? sum / static_cast<double>(a.size()) / scale : 0.0;
}

}  // namespace handloop::identify
