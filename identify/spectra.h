#pragma once

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

/// Spectra of a pair of signals by Welch's method, and the frequency response H1 and coherence that follow from them.
/// u is the input (force, N), y the output (position, m); y may be any other signal too.
namespace handloop::identify {

enum class Window { rectangular, hann, hamming };

/// Weights of a window. Symmetric: first and last weight equal (MATLAB's hamming(N)); periodic: one period of length N.
std::vector<double> make_window(Window window, std::size_t length, bool symmetric);

enum class MeanRemoval { none, record, segment };

struct WelchSettings {
  std::size_t segment = 8192;  ///< samples
  std::size_t overlap = 4096;  ///< samples, below segment
  Window window = Window::hann;
  bool symmetric = false;
  MeanRemoval mean = MeanRemoval::segment;
  std::size_t first_bin = 1;  ///< bins kept, both ends included
  std::size_t last_bin = 0;   ///< 0: up to half the sampling rate
};

/// The arm paper's settings as far as they fit together: 1914 samples, overlap 957, symmetric Hamming, the record's
/// mean removed, no detrending of segments, bins 1 to 57 (0.52 - 29.8 Hz). (It states 32 windows, 50 % overlap, N = 958
/// and p = 57, which no one segment length satisfies: 57 bins to 30 Hz ask for segments of 1.914 s.) At another rate
/// the segment keeps its duration.
WelchSettings paper_settings(double sample_time_s);

/// Segments of 8192 samples at 1 kHz (8.2 s; other rates: the power of two of the nearest duration), half overlapping,
/// periodic Hann, bins up to `highest_Hz`. Shorter records get the longest power of two that leaves seven segments.
WelchSettings long_segment_settings(std::size_t samples, double sample_time_s, double highest_Hz = 30.0);

/// One-sided averaged spectra. All vectors have one entry a kept bin.
struct Spectra {
  std::vector<double> frequency_Hz;
  std::vector<double> input_power;                ///< S_uu, u^2/Hz
  std::vector<double> output_power;               ///< S_yy, y^2/Hz
  std::vector<std::complex<double>> cross_power;  ///< S_uy = E conj(U) Y, u y/Hz
  std::size_t segments = 0;
  double averages = 0.0;  ///< independent averages that the overlapping segments amount to (Welch 1967)
};

/// Throws InputError where the signals differ in length, hold a value that is not finite, or are shorter than a
/// segment.
Spectra welch(std::span<const double> u, std::span<const double> y, double sample_time_s,
              const WelchSettings& settings);

/// A measured frequency response. All vectors have the same length.
struct FrequencyResponse {
  std::vector<double> frequency_Hz;
  std::vector<std::complex<double>> response;  ///< y/u; m/N for compliance
  std::vector<double> coherence;               ///< magnitude squared, 0..1
  std::vector<double> variance;                ///< of the response (total: E|H - H0|^2), from scatter between segments

  std::size_t size() const { return frequency_Hz.size(); }
};

/// H1 = S_uy/S_uu (MATLAB's tfestimate), coherence |S_uy|^2/(S_uu S_yy) and the variance (1 - c)/c |H|^2/averages.
/// A bin without input power has response, coherence 0 and infinite variance.
FrequencyResponse frequency_response(const Spectra& spectra);

/// Magnitude-squared coherence, as in FrequencyResponse.
std::vector<double> coherence(const Spectra& spectra);

}  // namespace handloop::identify
