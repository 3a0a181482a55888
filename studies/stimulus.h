#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

/// Forces that make an arm show its dynamics.
namespace handloop::studies {

enum class StimulusKind {
  noise,     ///< the arm paper's: Gaussian noise through a 13th-order Butterworth low-pass at 30 Hz
  multisine  ///< random-phase sines on an odd grid with gaps: what appears on the empty lines is noise (between
             ///< periods), even (even lines) or odd nonlinearity (empty odd lines)
};

/// "noise" or "multisine". Throws InputError for anything else.
StimulusKind parse_stimulus_kind(std::string_view text);
std::string_view stimulus_kind_name(StimulusKind kind);

struct StimulusSettings {
  StimulusKind kind = StimulusKind::noise;
  double rms_N = 0.0;  ///< before clipping
  double cap_N = 5.0;  ///< clipped there
  double cutoff_Hz = 30.0;
  double period_s = 10.0;  ///< of the multisine
  double sample_time_s = 0.001;
};

struct Stimulus {
  std::vector<double> force_N;  ///< one a sample
  std::size_t clipped_samples = 0;
  std::vector<int> lines;  ///< of the multisine: excited harmonics of 1/period
};

/// Of the multisine: odd harmonics of 1/period up to the cutoff, one of each four in a row left out at random.
std::vector<int> multisine_lines(std::uint64_t seed, double period_s, double cutoff_Hz);

/// A function of its arguments alone. Throws InputError where the settings are not possible.
Stimulus make_stimulus(const StimulusSettings& settings, std::size_t samples, std::uint64_t seed);

}  // namespace handloop::studies
