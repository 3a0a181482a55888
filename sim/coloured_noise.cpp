#include "sim/coloured_noise.h"

#include <cmath>
#include <numbers>
#include <stdexcept>

namespace handloop::sim {

ButterworthLowPass::ButterworthLowPass(int order, double cutoff_Hz, double rate_Hz) {
  if (order < 1 || !(cutoff_Hz > 0) || !(cutoff_Hz < 0.5 * rate_Hz)) {
    throw std::invalid_argument("a low-pass needs an order of at least 1 and a cutoff below half the rate");
  }
  const double k = std::tan(std::numbers::pi * cutoff_Hz / rate_Hz);
  if (order % 2 == 1) {
    const double b = k / (1 + k);
    sections_.push_back({b, b, 0, (k - 1) / (1 + k), 0});
  }
  for (int pair = 1; pair <= order / 2; ++pair) {
    // s^2 + 2 cos(angle) s + 1: the poles lie at this angle from the negative real axis
    const double angle = std::numbers::pi * (order % 2 == 1 ? pair : pair - 0.5) / order;
    const double damping = 2 * std::cos(angle);
    const double a0 = 1 + damping * k + k * k;
    const double b = k * k / a0;
    sections_.push_back({b, 2 * b, b, 2 * (k * k - 1) / a0, (1 - damping * k + k * k) / a0});
  }
}

double ButterworthLowPass::filter(double input) {
  for (auto& s : sections_) {
    const double output = s.b0 * input + s.z1;
    s.z1 = s.b1 * input - s.a1 * output + s.z2;
    s.z2 = s.b2 * input - s.a2 * output;
    input = output;
  }
  return input;
}

void ButterworthLowPass::reset() {
  for (auto& s : sections_) s.z1 = s.z2 = 0.0;
}

ColouredNoise::ColouredNoise(std::uint64_t seed, models::RandomStream stream, std::uint32_t substream, double rate_Hz,
                             double cutoff_Hz, int order)
    : random_(seed, stream, substream), low_pass_(order, cutoff_Hz, rate_Hz) {
  // variance of the output for unit white noise: the energy of the impulse response, which lasts some tens of periods
  const int length = static_cast<int>(200 * rate_Hz / cutoff_Hz);
  double energy = 0;
  for (int i = 0; i < length; ++i) {
    const double h = low_pass_.filter(i == 0 ? 1.0 : 0.0);
    energy += h * h;
  }
  low_pass_.reset();
  scale_ = 1.0 / std::sqrt(energy);
}

double ColouredNoise::next() {
  return scale_ * low_pass_.filter(random_.normal(index_++));
}

void ColouredNoise::reset() {
  low_pass_.reset();
  index_ = 0;
}

}  // namespace handloop::sim
