#pragma once

#include <array>
#include <cstdint>
#include <vector>

/// Recordings of the five-parameter arm for tests, made without any of the code under test: the arm's differential
/// equations in the time domain, advanced by matrix exponentials that are exact for the force between samples. (The
/// fits work in the frequency domain on eq. (1).)
namespace handloop::test {

enum class Drive {
  held_force,    ///< the force on the hand is a DAC's: constant until the next sample
  ramped_force,  ///< straight lines between samples
  device  ///< the DAC drives a device of `device_mass_kg` that the hand holds; the recorded force is what is felt
};

struct RecordingPlan {
  std::array<double, 5> arm{};  ///< M, k1, k2, b1, b2
  Drive drive = Drive::device;
  double device_mass_kg = 0.075;
  double device_damping_Ns_per_m = 0.05;
  double duration_s = 60.0;
  double sample_time_s = 0.001;
  double force_rms_N = 1.25;      ///< before clipping at 5 N
  double position_step_m = 3e-5;  ///< quantisation; 0: none
  double position_noise_m = 0.0;
  double force_noise_N = 0.003;
  double force_step_N = 5.2e-4;
  double wander_rms_m = 0.0;  ///< slow voluntary motion added to the hand's position, below about 0.4 Hz
  std::uint64_t seed = 1;
};

struct ArmRecording {
  std::vector<double> force_N, position_m;
  std::vector<double> true_position_m;  ///< without noise, quantisation and wander
};

/// Gaussian white noise through a 13th-order Butterworth low-pass at `cutoff_Hz` (bilinear, prewarped), unit variance.
std::vector<double> coloured_noise(std::size_t count, double sample_time_s, double cutoff_Hz, std::uint64_t seed);

ArmRecording record_arm(const RecordingPlan& plan);

/// Random arms spread over the ranges of Table III (axis 0..2 = X, Y, Z), cut normals: M, k1, k2, b1, b2.
std::vector<std::array<double, 5>> random_arms(int axis, std::size_t count, std::uint64_t seed);

}  // namespace handloop::test
