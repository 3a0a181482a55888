#include "models/effects/entry.h"

namespace handloop::models {
namespace {

const EffectInfo kInfo{
    .name = "time_delay",
    .title = "Time delay",
    .equation = "y(t) = u(t - delay_s)",
    .source = "transport, computation or communication between the signal and its record",
    .fingerprint = "phase that falls in proportion to frequency, no loss of size",
    .experiment = "excitation up to 60 Hz: a delay keeps falling, a lag levels off",
    .places = {Place::sensor, Place::actuator},
    .parameters =
        {{"delay_s", "s", 0.0, 0.2, 0.005, "how late the signal is", {Role::shape, 0.001, 0.04, 4, Scale::absolute}}},
    .search_places = {Place::sensor},
};

class TimeDelay final : public Effect {
 public:
  TimeDelay(Place place, std::span<const double> values) : Effect(kInfo, place, values) {}
  double delay_s() const override { return value(0); }
  LinearElement linearise(const OperatingPoint&, const PortBase&) const override {
    return {.numerator = {1.0}, .denominator = {1.0}, .delay_s = value(0)};
  }
};

}  // namespace

EffectType time_delay_effect() {
  return effect_entry<TimeDelay>(kInfo);
}

}  // namespace handloop::models
