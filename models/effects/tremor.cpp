#include <array>
#include <cmath>
#include <numbers>

#include "models/effects/entry.h"

namespace handloop::models {
namespace {

const EffectInfo kInfo{
    .name = "tremor",
    .title = "Tremor",
    .equation = "F = -amplitude_N sqrt(2) sum of seven sines of equal power within frequency_Hz +- bandwidth_Hz/2",
    .source = "physiological tremor 8-12 Hz, Elble and Koller 1990; no feedback, so it moves no margin",
    .fingerprint = "spectral line that the input does not explain",
    .experiment = "the same posture without excitation",
    .places = {Place::arm},
    .parameters = {{"amplitude_N", "N", 0.0, 1e3, 0.05, "rms of the force on the arm"},
                   {"frequency_Hz", "Hz", 1.0, 60.0, 9.0, "centre of the band"},
                   {"bandwidth_Hz", "Hz", 0.0, 10.0, 0.5, "width of the band"},
                   {"phase_rad",
                    "rad",
                    -10.0,
                    10.0,
                    0.0,
                    "of the centre line at the start",
                    {Role::choice, 0, 0, 1, Scale::absolute}}},
};

class Tremor final : public Effect {
 public:
  Tremor(Place place, std::span<const double> values) : Effect(kInfo, place, values) {}
  double force_N(const PortMotion& motion, const PortBase&, std::span<const double>) const override {
    // Golden-ratio phases: no two lines start alike and the envelope wanders.
    constexpr int kLines = 7;
    double sum = 0;
    for (int i = 0; i < kLines; ++i) {
      const double frequency = value(1) + value(2) * (static_cast<double>(i) / (kLines - 1) - 0.5);
      const double phase = value(3) + 2 * std::numbers::pi * 0.618033988749895 * i * i;
      sum += std::sin(2 * std::numbers::pi * frequency * motion.t_s + phase);
    }
    return -value(0) * std::sqrt(2.0 / kLines) * sum;
  }
  LinearElement linearise(const OperatingPoint&, const PortBase&) const override { return {}; }
};

}  // namespace

EffectType tremor_effect() {
  return effect_entry<Tremor>(kInfo);
}

}  // namespace handloop::models
