#include "identify/recording_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "models/errors.h"

namespace handloop::identify {

namespace {

/// A hand that holds a stylus does not move by more than this (rms about the mean), nor is it pushed harder.
constexpr double kLargestPosition_m = 0.3;
constexpr double kLargestForce_N = 300.0;

constexpr double kLowestRate_Hz = 20.0;

/// Share of samples at an extreme value above which a channel counts as limited, and time without any change above
/// which it counts as stuck.
constexpr double kLimitedShare = 0.002;
constexpr double kStuck_s = 2.0;

/// Distance from the mean, in rms, that no motion has: one sample among thousands does, a glitch of the sensor. Above
/// the larger limit the rest of the signal is lost beside it.
constexpr double kPeakDoubted = 25.0, kPeakRefused = 100.0;

struct Channel {
  double mean = 0, rms = 0, low = 0, high = 0;
  double peak = 0.0;  ///< of the sample farthest from the mean
  std::size_t peak_at = 0;
  std::size_t at_low = 0, at_high = 0;
  std::size_t longest_run = 0, run_start = 0;

  double peak_in_rms() const { return std::abs(peak - mean) / rms; }
};

Channel examine(std::span<const double> signal, const std::string& name, const char* column) {
  Channel c;
  c.low = c.high = signal[0];
  for (std::size_t n = 0; n < signal.size(); ++n) {
    if (!std::isfinite(signal[n])) {
      throw InputError(
          fmt::format("{}: {} has no finite value at sample {}; leave out or repair the gap", name, column, n + 1));
    }
    c.low = std::min(c.low, signal[n]);
    c.high = std::max(c.high, signal[n]);
    c.mean += signal[n] / static_cast<double>(signal.size());
  }
  if (!(c.high > c.low)) {
    throw InputError(
        fmt::format("{}: {} is constant ({:.6g}); a dead channel or the wrong column, nothing can be identified", name,
                    column, c.low));
  }
  const double width = 1e-9 * (c.high - c.low);
  std::size_t run = 1;
  for (std::size_t n = 0; n < signal.size(); ++n) {
    c.rms += (signal[n] - c.mean) * (signal[n] - c.mean) / static_cast<double>(signal.size());
    if (std::abs(signal[n] - c.mean) > std::abs(c.peak - c.mean) || n == 0) {
      c.peak = signal[n];
      c.peak_at = n;
    }
    c.at_low += signal[n] <= c.low + width;
    c.at_high += signal[n] >= c.high - width;
    run = n > 0 && signal[n] == signal[n - 1] ? run + 1 : 1;
    if (run > c.longest_run) {
      c.longest_run = run;
      c.run_start = n + 1 - run;
    }
  }
  c.rms = std::sqrt(c.rms);
  if (c.peak_in_rms() > kPeakRefused) {
    throw InputError(
        fmt::format("{}: {} is {:.6g} at sample {}, {:.3g} times its rms: one sample beside which the rest "
                    "is nothing, a glitch of the sensor; repair it or cut the recording there",
                    name, column, c.peak, c.peak_at + 1, c.peak_in_rms()));
  }
  return c;
}

void doubt(const Channel& c, const char* column, const models::Recording& recording, std::vector<std::string>& doubts) {
  const double count = static_cast<double>(recording.size());
  for (const auto& [times, value] : {std::pair{c.at_low, c.low}, std::pair{c.at_high, c.high}}) {
    const double share = static_cast<double>(times) / count;
    // A quantised channel visits its extreme now and then; a limited one stays there.
    if (times > 10 && share > kLimitedShare) {
      doubts.push_back(
          fmt::format("{} stands at its extreme {:.6g} in {:.2g} % of the samples: if the sensor was saturated "
                      "there (and not the force itself limited), the fit is wrong",
                      column, value, 100 * share));
    }
  }
  if (c.peak_in_rms() > kPeakDoubted) {
    doubts.push_back(fmt::format("{} is {:.6g} at sample {}, {:.3g} times its rms: a glitch of the sensor?", column,
                                 c.peak, c.peak_at + 1, c.peak_in_rms()));
  }
  const double stuck = static_cast<double>(c.longest_run) * recording.sample_time_s;
  if (stuck > kStuck_s) {
    doubts.push_back(fmt::format("{} does not change at all for {:.3g} s from t = {:.3f} s on", column, stuck,
                                 recording.start_time_s + static_cast<double>(c.run_start) * recording.sample_time_s));
  }
}

}  // namespace

std::vector<std::string> check_recording(const models::Recording& recording) {
  const auto& name = recording.name;
  if (recording.size() == 0 || recording.position_m.size() != recording.size()) {
    throw InputError(fmt::format("{}: {} samples of force and {} of position; both need the same number", name,
                                 recording.size(), recording.position_m.size()));
  }
  if (!(recording.sample_time_s > 0)) throw InputError(fmt::format("{}: no sampling rate; give it with --rate", name));
  if (1 / recording.sample_time_s < kLowestRate_Hz) {
    throw InputError(
        fmt::format("{}: sampled at {:.3g} Hz; an arm's resonance at 2 to 4 Hz asks for {:g} Hz or more (are "
                    "the times milliseconds? Then name the column time_ms, or give --rate)",
                    name, 1 / recording.sample_time_s, kLowestRate_Hz));
  }
  const Channel force = examine(recording.force_N, name, "the force");
  const Channel position = examine(recording.position_m, name, "the position");
  if (!recording.rotary && recording.position_unit == "m" && recording.force_unit == "N") {
    if (position.rms > 100 * force.rms && position.rms > 0.01) {
      throw InputError(
          fmt::format("{}: the position moves by {:.3g} m under {:.3g} N (rms); are the columns exchanged? Name "
                      "them with --force and --position",
                      name, position.rms, force.rms));
    }
    if (position.rms > kLargestPosition_m) {
      throw InputError(
          fmt::format("{}: the position moves by {:.3g} m rms, more than an arm does; give it in metres (are these "
                      "millimetres, or are force and position exchanged?)",
                      name, position.rms));
    }
    if (force.rms > kLargestForce_N) {
      throw InputError(
          fmt::format("{}: the force is {:.3g} N rms, more than a hand holds; give it in newtons", name, force.rms));
    }
  }
  std::vector<std::string> doubts;
  doubt(force, "the force", recording, doubts);
  doubt(position, "the position", recording, doubts);
  return doubts;
}

}  // namespace handloop::identify
