#include "models/effects/entry.h"

namespace handloop::models {
namespace {

const EffectInfo kInfo{
    .name = "offset",
    .title = "Offset",
    .equation = "at the actuator the plant receives force + force_N; at the sensor position + position_m is read",
    .source = "zero of an amplifier, a sensor or a posture",
    .fingerprint = "constant error",
    .experiment = "a record at rest before and after",
    .places = {Place::actuator, Place::sensor},
    .parameters = {{"force_N", "N", -1e4, 1e4, 0.0, "constant force added (actuator)"},
                   {"position_m", "m", -10.0, 10.0, 0.0, "constant position added (sensor)"}},
    .search_places = {Place::actuator, Place::sensor},
};

class Offset final : public Effect {
 public:
  Offset(Place place, std::span<const double> values) : Effect(kInfo, place, values) {}
  double signal_addition(double) const override { return place() == Place::actuator ? value(0) : value(1); }
  bool uses(std::size_t parameter) const override { return parameter == (place() == Place::actuator ? 0 : 1); }
  LinearElement linearise(const OperatingPoint&, const PortBase&) const override {
    return {.numerator = {1.0}, .denominator = {1.0}};
  }
};

}  // namespace

EffectType offset_effect() {
  return effect_entry<Offset>(kInfo);
}

}  // namespace handloop::models
