#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "models/random.h"

namespace handloop::sim {

/// Butterworth low-pass of any order as a chain of second-order sections (bilinear transform, the cutoff prewarped):
/// the only form in which an order of 13 at 30 Hz of 1 kHz keeps its poles where they belong. Real-time safe after
/// construction.
class ButterworthLowPass {
 public:
  /// Throws std::invalid_argument unless order > 0 and 0 < cutoff < rate/2.
  ButterworthLowPass(int order, double cutoff_Hz, double rate_Hz);
  double filter(double input);
  void reset();

 private:
  struct Section {
    double b0, b1, b2, a1, a2;
    double z1 = 0.0, z2 = 0.0;
  };
  std::vector<Section> sections_;
};

/// Gaussian noise of unit rms up to a cutoff: the arm paper's stimulus (white noise through a 13th-order Butterworth
/// filter at 30 Hz). Sample i is a function of seed, stream and i alone, but must be asked in order. Real-time safe
/// after construction.
class ColouredNoise {
 public:
  ColouredNoise(std::uint64_t seed, models::RandomStream stream, std::uint32_t substream, double rate_Hz,
                double cutoff_Hz = 30.0, int order = 13);
  double next();
  void reset();

 private:
  models::CounterRandom random_;
  ButterworthLowPass low_pass_;
  double scale_ = 1.0;
  std::uint64_t index_ = 0;
};

}  // namespace handloop::sim
