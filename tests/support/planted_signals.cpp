#include "tests/support/planted_signals.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

namespace handloop::tests {

double Draw::uniform(double low, double high) {
  return low + (high - low) * static_cast<double>(engine_() >> 11) * 0x1.0p-53;
}

double Draw::log_uniform(double low, double high) {
  return low * std::pow(high / low, uniform(0, 1));
}

double Draw::normal() {
  const double radius = std::sqrt(-2 * std::log(1 - uniform(0, 1)));
  return radius * std::cos(2 * std::numbers::pi * uniform(0, 1));
}

void butterworth_low_pass(std::vector<double>& samples, int order, double cutoff_Hz, double sample_time_s) {
  const double c = 1 / std::tan(std::numbers::pi * cutoff_Hz * sample_time_s);  // bilinear, prewarped
  for (int i = 0; i < order / 2; ++i) {
    const double damping = 2 * std::cos(std::numbers::pi * (2 * i + 1 + (order % 2)) / (2.0 * order));
    const double a0 = c * c + damping * c + 1, a1 = 2 * (1 - c * c), a2 = c * c - damping * c + 1;
    double s1 = 0, s2 = 0;
    for (double& value : samples) {
      const double y = (value + s1) / a0;
      s1 = 2 * value - a1 * y + s2;
      s2 = value - a2 * y;
      value = y;
    }
  }
  if (order % 2 == 1) {
    double s = 0;
    for (double& value : samples) {
      const double y = (value + s) / (c + 1);
      s = value - (1 - c) * y;
      value = y;
    }
  }
}

double rms(const std::vector<double>& a) {
  double sum = 0;
  for (const double value : a) sum += value * value;
  return a.empty() ? 0 : std::sqrt(sum / static_cast<double>(a.size()));
}

std::vector<double> coloured_force(Draw& draw, std::size_t count, double sample_time_s, double target_rms, double cap) {
  const std::size_t settle = static_cast<std::size_t>(1.0 / sample_time_s);
  std::vector<double> samples(count + settle);
  for (double& value : samples) value = draw.normal();
  butterworth_low_pass(samples, 13, 30.0, sample_time_s);
  samples.erase(samples.begin(), samples.begin() + static_cast<std::ptrdiff_t>(settle));
  const double scale = target_rms / rms(samples);
  for (double& value : samples) value = std::clamp(value * scale, -cap, cap);
  return samples;
}

std::vector<double> slow_wander(Draw& draw, std::size_t count, double sample_time_s, double target_rms) {
  std::vector<double> samples(count, 0.0);
  if (target_rms <= 0) return samples;
  const std::size_t settle = static_cast<std::size_t>(20.0 / sample_time_s);
  std::vector<double> run(count + settle);
  for (double& value : run) value = draw.normal();
  butterworth_low_pass(run, 2, draw.uniform(0.1, 0.25), sample_time_s);
  std::copy(run.begin() + static_cast<std::ptrdiff_t>(settle), run.end(), samples.begin());
  const double scale = target_rms / rms(samples);
  for (std::size_t i = 0; i < count; ++i) samples[i] *= scale * std::min(1.0, static_cast<double>(i) * sample_time_s);
  return samples;
}

std::vector<double> narrow_band(Draw& draw, std::size_t count, double sample_time_s, double frequency_Hz,
                                double bandwidth_Hz) {
  // a resonator of two poles fed with noise; run in long enough to forget its start
  const double radius = std::exp(-std::numbers::pi * bandwidth_Hz * sample_time_s);
  const double a1 = 2 * radius * std::cos(2 * std::numbers::pi * frequency_Hz * sample_time_s), a2 = -radius * radius;
  const std::size_t settle = static_cast<std::size_t>(5.0 / (bandwidth_Hz * sample_time_s));
  double y1 = 0, y2 = 0;
  std::vector<double> samples;
  samples.reserve(count);
  for (std::size_t i = 0; i < count + settle; ++i) {
    const double y = a1 * y1 + a2 * y2 + draw.normal();
    y2 = y1;
    y1 = y;
    if (i >= settle) samples.push_back(y);
  }
  const double scale = 1 / rms(samples);
  for (double& value : samples) value *= scale;
  return samples;
}

double quantised(double value, double step) {
  return step > 0 ? step * std::round(value / step) : value;
}

double rms_difference(const std::vector<double>& a, const std::vector<double>& b, std::size_t from) {
  double sum = 0;
  for (std::size_t i = from; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return from < a.size() ? std::sqrt(sum / static_cast<double>(a.size() - from)) : 0;
}

}  // namespace handloop::tests
