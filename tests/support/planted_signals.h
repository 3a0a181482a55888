#pragma once

#include <cstdint>
#include <random>
#include <vector>

/// Signals of the other laboratory: excitation, noise, wander, tremor.
namespace handloop::tests {

/// Random draws of one recording.
class Draw {
 public:
  explicit Draw(std::uint64_t seed) : engine_(seed * 0x9E3779B97F4A7C15ull + 0x632BE59BD9B4E019ull) {}
  double uniform(double low, double high);
  double log_uniform(double low, double high);
  double normal();
  bool chance(double probability) { return uniform(0, 1) < probability; }
  int pick(int count) { return static_cast<int>(uniform(0, 1) * count * 0.999999999); }
  std::uint64_t bits() { return engine_(); }

 private:
  std::mt19937_64 engine_;
};

/// Low-pass of any order by bilinear Butterworth sections, run over the samples in place.
void butterworth_low_pass(std::vector<double>& samples, int order, double cutoff_Hz, double sample_time_s);

/// White noise through the 13th-order 30 Hz Butterworth low-pass, scaled to the rms and cut at +-cap.
std::vector<double> coloured_force(Draw& draw, std::size_t count, double sample_time_s, double rms, double cap);

/// Slow voluntary motion: noise below about 0.3 Hz of this rms, fading in over the first second; zero where rms is 0.
std::vector<double> slow_wander(Draw& draw, std::size_t count, double sample_time_s, double rms);

/// Narrow-band noise about a frequency, unit rms.
std::vector<double> narrow_band(Draw& draw, std::size_t count, double sample_time_s, double frequency_Hz,
                                double bandwidth_Hz);

double quantised(double value, double step);
/// Root mean square of a - b over samples [from, size).
double rms_difference(const std::vector<double>& a, const std::vector<double>& b, std::size_t from);
double rms(const std::vector<double>& a);

}  // namespace handloop::tests
