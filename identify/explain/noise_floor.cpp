#include "identify/explain/noise_floor.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "identify/explain/signals.h"
#include "identify/spectra.h"

namespace handloop::identify {
namespace {

constexpr double kWanderBelow_Hz = 0.5;

double power_between(const Spectra& spectra, const std::vector<double>& weight, double from_Hz, double to_Hz) {
  double sum = 0;
  const double width = spectra.frequency_Hz.size() > 1 ? spectra.frequency_Hz[1] - spectra.frequency_Hz[0] : 0.0;
  for (std::size_t i = 0; i < spectra.frequency_Hz.size(); ++i) {
    if (spectra.frequency_Hz[i] >= from_Hz && spectra.frequency_Hz[i] < to_Hz)
      sum += weight[i] * spectra.output_power[i] * width;
  }
  return sum;
}

/// Spectra of the input and of what the base model leaves of the output.
Spectra residual_spectra(const Prediction& prediction, const models::AxisModel& base) {
  const double h = prediction.sample_time_s();
  const auto& output = prediction.measured();
  const auto& input =
      prediction.driven_by() == DrivenBy::force ? prediction.recording().force_N : prediction.recording().position_m;
  const auto run = prediction.run(base, false, true);
  std::vector<double> residual(output.size());
  for (std::size_t i = 0; i < residual.size(); ++i) residual[i] = output[i] - (run.finite ? run.output[i] : 0.0);
  return welch(input, residual, h, long_segment_settings(residual.size(), h, 0.5 / h));
}

double mean_power_density(const Spectra& spectra, double from_Hz, double to_Hz) {
  return power_between(spectra, std::vector<double>(spectra.frequency_Hz.size(), 1.0), from_Hz, to_Hz) /
         (to_Hz - from_Hz);
}

/// Of a spectrum from 1.5 to 4 Hz beside a frequency; nothing where that is too little or empty.
std::optional<double> median_around(const std::vector<double>& frequency_Hz, const std::vector<double>& power,
                                    double at_Hz) {
  std::vector<double> around;
  for (std::size_t j = 1; j < power.size(); ++j) {
    const double away = std::abs(frequency_Hz[j] - at_Hz);
    if (away > 1.5 && away < 4.0 && frequency_Hz[j] > 1.5) around.push_back(power[j]);
  }
  if (around.size() < 5) return std::nullopt;
  const auto middle = around.begin() + static_cast<std::ptrdiff_t>(around.size() / 2);
  std::nth_element(around.begin(), middle, around.end());
  return *middle > 0 ? std::optional(*middle) : std::nullopt;
}

/// A mode near this frequency that rings for more than about half a second, so that a segment's input does not explain
/// what it still does: an error of the model there looks like a line of the hand's own.
bool rings_on(const std::function<double(double)>& response, double at_Hz) {
  double most = 0;
  for (int k = -15; k <= 15; ++k) most = std::max(most, response(at_Hz + 0.05 * k));
  return most > 6 * std::max(response(at_Hz - 1.5), response(at_Hz + 1.5));
}

double peak(const std::vector<double>& values, std::size_t at) {
  return (values[at - 1] + values[at] + values[at + 1]) / 3;
}

}  // namespace

NoiseFloor estimate_noise_floor(const Prediction& prediction, const models::AxisModel& base) {
  NoiseFloor floor;
  const double nyquist = 0.5 / prediction.sample_time_s();
  const auto of_output = residual_spectra(prediction, base);
  const double from = 0.6 * nyquist, to = 0.95 * nyquist;
  const double level = mean_power_density(of_output, from, to);
  floor.sensor = std::sqrt(std::max(0.0, level * nyquist));
  auto incoherent = coherence(of_output);
  for (double& value : incoherent) value = 1 - value;
  floor.wander =
      std::sqrt(std::max(0.0, power_between(of_output, incoherent, 0.0, kWanderBelow_Hz) - level * kWanderBelow_Hz));
  floor.rmse = std::hypot(floor.sensor, floor.wander);
  floor.how = "white level of the residual from " + std::to_string(static_cast<int>(from)) + " to " +
              std::to_string(static_cast<int>(to)) + " Hz, and what is incoherent with the input below 0.5 Hz";
  return floor;
}

double filtered_noise(const Prediction& prediction, const models::AxisModel& base) {
  const double nyquist = 0.5 / prediction.sample_time_s();
  const auto spectra = residual_spectra(prediction, base);
  double level = mean_power_density(spectra, 0.6 * nyquist, 0.95 * nyquist);
  for (const double from : {0.12, 0.25}) {
    level = std::min(level, mean_power_density(spectra, from * nyquist, 2 * from * nyquist));
  }
  return std::sqrt(level * std::min(nyquist, 0.5 * prediction.filter().rate_Hz));
}

SpectralLine find_line(std::span<const double> residual, std::span<const double> input, double sample_time_s,
                       const std::function<double(double)>& response) {
  SpectralLine line;
  WelchSettings settings;
  settings.segment = std::min<std::size_t>(residual.size() / 4, static_cast<std::size_t>(4.096 / sample_time_s));
  if (settings.segment < 64) return line;
  settings.overlap = settings.segment / 2;
  settings.window = Window::hann;
  // surroundings reach to 4 Hz beyond the highest line
  settings.last_bin =
      std::min(settings.segment / 2,
               static_cast<std::size_t>(std::ceil(20.0 * sample_time_s * static_cast<double>(settings.segment))));
  const auto spectra = welch(input, residual, sample_time_s, settings);
  const auto coherent = coherence(spectra);
  const auto& f = spectra.frequency_Hz;
  const auto& power = spectra.output_power;
  const double width = f.size() > 1 ? f[1] - f[0] : 1.0;
  std::vector<double> force(power.size(), 0.0);
  for (std::size_t i = 1; i < f.size(); ++i) force[i] = power[i] / std::norm(response(f[i]));
  for (std::size_t i = 2; i + 2 < f.size(); ++i) {
    if (f[i] < 3.0 || f[i] > 16.0) continue;
    const auto around = median_around(f, force, f[i]), seen = median_around(f, power, f[i]);
    if (!around || !seen) continue;
    const double ratio = std::min(peak(force, i) / *around, peak(power, i) / *seen);
    if (ratio > line.ratio && !rings_on(response, f[i])) {
      line.ratio = ratio;
      line.frequency_Hz = f[i];
      line.coherence = peak(coherent, i);
      double sum = 0;
      std::size_t above = 0;
      for (std::size_t j = 1; j < f.size(); ++j) {
        if (std::abs(f[j] - f[i]) > 1.5) continue;
        sum += std::max(0.0, force[j] - *around) * width;
        above += force[j] > 0.5 * force[i] ? 1 : 0;
      }
      line.force_rms = std::sqrt(sum);
      line.bandwidth_Hz = static_cast<double>(above) * width;
    }
  }
  // the largest of some fifty bins of a spectrum averaged a dozen times stays below 3 by chance
  line.significant = line.ratio > 6.0 && line.coherence < 0.4 && line.frequency_Hz > 3.6 && line.bandwidth_Hz < 2.0;
  return line;
}

}  // namespace handloop::identify
