#include "models/effects/entry.h"

namespace handloop::models {
namespace {

const EffectInfo kInfo{
    .name = "sensor_lag",
    .title = "Sensor lag",
    .equation = "time_constant_s y' = u - y",
    .source = "first-order sensor, amplifier or smoothing filter",
    .fingerprint = "phase that falls and size that shrinks as of a first-order lag",
    .experiment = "excitation up to 60 Hz: a lag levels off, a delay keeps falling",
    .places = {Place::sensor, Place::actuator},
    .parameters = {{"time_constant_s",
                    "s",
                    0.0,
                    0.5,
                    0.005,
                    "of the first-order lag",
                    {Role::shape, 0.001, 0.04, 4, Scale::absolute}}},
    .search_places = {Place::sensor},
};

class SensorLag final : public Effect {
 public:
  SensorLag(Place place, std::span<const double> values) : Effect(kInfo, place, values) {}
  LinearElement linearise(const OperatingPoint&, const PortBase&) const override {
    return {.numerator = {1.0}, .denominator = {value(0), 1.0}};
  }
};

}  // namespace

EffectType sensor_lag_effect() {
  return effect_entry<SensorLag>(kInfo);
}

}  // namespace handloop::models
