#include "studies/stimulus.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "models/errors.h"
#include "models/random.h"
#include "sim/coloured_noise.h"

namespace handloop::studies {
namespace {

using models::CounterRandom;
using models::RandomStream;

constexpr int kOrder = 13;

std::vector<double> noise(const StimulusSettings& settings, std::size_t samples, std::uint64_t seed) {
  sim::ColouredNoise source(seed, RandomStream::excitation, 0, 1.0 / settings.sample_time_s, settings.cutoff_Hz,
                            kOrder);
  std::vector<double> force(samples);
  for (auto& f : force) f = settings.rms_N * source.next();
  return force;
}

std::vector<double> multisine(const StimulusSettings& settings, std::size_t samples, std::uint64_t seed,
                              const std::vector<int>& lines) {
  const auto period = static_cast<std::size_t>(std::lround(settings.period_s / settings.sample_time_s));
  const CounterRandom phases(seed, RandomStream::excitation, 1);
  const double amplitude = settings.rms_N * std::sqrt(2.0 / static_cast<double>(lines.size()));
  std::vector<double> one(period, 0.0);
  for (const int line : lines) {
    const double phase = 2 * std::numbers::pi * phases.uniform(line);
    const double rate = 2 * std::numbers::pi * line / static_cast<double>(period);
    for (std::size_t n = 0; n < period; ++n) one[n] += amplitude * std::cos(rate * static_cast<double>(n) + phase);
  }
  std::vector<double> force(samples);
  for (std::size_t n = 0; n < samples; ++n) force[n] = one[n % period];
  return force;
}

}  // namespace

StimulusKind parse_stimulus_kind(std::string_view text) {
  if (text == "noise") return StimulusKind::noise;
  if (text == "multisine") return StimulusKind::multisine;
  throw InputError("unknown stimulus '" + std::string(text) + "': give noise or multisine");
}

std::string_view stimulus_kind_name(StimulusKind kind) {
  return kind == StimulusKind::noise ? "noise" : "multisine";
}

std::vector<int> multisine_lines(std::uint64_t seed, double period_s, double cutoff_Hz) {
  const int highest = static_cast<int>(std::floor(cutoff_Hz * period_s + 1e-9));
  const CounterRandom random(seed, RandomStream::excitation, 2);
  std::vector<int> lines;
  for (int group = 0; 8 * group + 1 <= highest; ++group) {
    const auto left_out = static_cast<int>(4 * random.uniform(group));
    for (int i = 0; i < 4; ++i) {
      const int line = 8 * group + 2 * i + 1;
      if (i != left_out && line <= highest) lines.push_back(line);
    }
  }
  return lines;
}

Stimulus make_stimulus(const StimulusSettings& settings, std::size_t samples, std::uint64_t seed) {
  if (!(settings.rms_N > 0) || !std::isfinite(settings.rms_N))
    throw InputError("the stimulus needs an rms force above zero");
  if (!(settings.cap_N > 0)) throw InputError("the motors have no force left for a stimulus at this pose");
  Stimulus stimulus;
  if (settings.kind == StimulusKind::noise) {
    stimulus.force_N = noise(settings, samples, seed);
  } else {
    stimulus.lines = multisine_lines(seed, settings.period_s, settings.cutoff_Hz);
    if (stimulus.lines.empty()) throw InputError("the multisine's period is too short: no line lies below its cutoff");
    stimulus.force_N = multisine(settings, samples, seed, stimulus.lines);
  }
  for (auto& force : stimulus.force_N) {
    const double held = std::clamp(force, -settings.cap_N, settings.cap_N);
    if (held != force) ++stimulus.clipped_samples;
    force = held;
  }
  return stimulus;
}

}  // namespace handloop::studies
