#include "identify/variability.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <stdexcept>

#include "identify/minimum_circle.h"

namespace handloop::identify {

using Complex = std::complex<double>;

namespace {

void require_same_frequencies(std::span<const FrequencyResponse> responses) {
  if (responses.empty()) throw std::invalid_argument("no responses");
  for (const auto& r : responses) {
    if (r.frequency_Hz != responses.front().frequency_Hz)
      throw std::invalid_argument("responses at different frequencies");
  }
}

}  // namespace

double empirical_quantile(std::span<const double> values, double p) {
  if (values.empty()) throw std::invalid_argument("a quantile needs a value");
  std::vector<double> sorted(values.begin(), values.end());
  std::sort(sorted.begin(), sorted.end());
  // Rank ceil(p n); the small allowance keeps 0.95 * 40 = 38.000000000000004 at 38.
  const double rank = std::ceil(p * static_cast<double>(sorted.size()) - 1e-9);
  return sorted[static_cast<std::size_t>(std::clamp(rank, 1.0, static_cast<double>(sorted.size()))) - 1];
}

models::ParameterStatistics describe(std::span<const double> values, models::PercentileReading reading) {
  const auto p = models::percentile_probabilities(reading);
  models::ParameterStatistics s{};
  const double count = static_cast<double>(values.size());
  s.minimum = empirical_quantile(values, 0);
  s.maximum = empirical_quantile(values, 1);
  s.mean = std::accumulate(values.begin(), values.end(), 0.0) / count;
  double squares = 0;
  for (const double v : values) squares += (v - s.mean) * (v - s.mean);
  s.standard_deviation = values.size() > 1 ? std::sqrt(squares / (count - 1)) : 0.0;
  s.ci95_minimum = empirical_quantile(values, p[1]);
  s.ci67_minimum = empirical_quantile(values, p[2]);
  s.ci67_maximum = empirical_quantile(values, p[3]);
  s.ci95_maximum = empirical_quantile(values, p[4]);
  return s;
}

FrequencyResponse mean_response(std::span<const FrequencyResponse> responses) {
  require_same_frequencies(responses);
  FrequencyResponse out = responses.front();
  const double count = static_cast<double>(responses.size());
  for (std::size_t n = 0; n < out.size(); ++n) {
    Complex sum = 0;
    double coherence = 0, variance = 0;
    for (const auto& r : responses) {
      sum += r.response[n];
      coherence += r.coherence[n];
      variance += r.variance[n];
    }
    out.response[n] = sum / count;
    out.coherence[n] = coherence / count;
    out.variance[n] = variance / (count * count);
  }
  return out;
}

FrequencyResponse central_response(std::span<const FrequencyResponse> responses) {
  require_same_frequencies(responses);
  FrequencyResponse out = responses.front();
  std::vector<Complex> points(responses.size());
  for (std::size_t n = 0; n < out.size(); ++n) {
    for (std::size_t r = 0; r < responses.size(); ++r) points[r] = responses[r].response[n];
    out.response[n] = minimum_circle(points).centre;
    out.coherence[n] = 1.0;
    out.variance[n] = 0.0;
  }
  return out;
}

UnstructuredVariability unstructured_variability(std::span<const FrequencyResponse> responses,
                                                 const models::ArmParameters& nominal) {
  require_same_frequencies(responses);
  UnstructuredVariability out;
  out.frequency_Hz = responses.front().frequency_Hz;
  std::vector<double> size(responses.size());
  for (std::size_t n = 0; n < out.frequency_Hz.size(); ++n) {
    const Complex centre = models::compliance(nominal, Complex(0, 2 * std::numbers::pi * out.frequency_Hz[n]));
    for (std::size_t r = 0; r < responses.size(); ++r) {
      size[r] = 20 * std::log10(std::max(std::abs(responses[r].response[n] / centre - 1.0), 1e-15));
    }
    out.maximum_dB.push_back(empirical_quantile(size, 1.0));
    out.percentile95_dB.push_back(empirical_quantile(size, 0.95));
    out.percentile67_dB.push_back(empirical_quantile(size, 0.67));
  }
  return out;
}

}  // namespace handloop::identify
