#include "models/effects/entry.h"

namespace handloop::models {
namespace {

const EffectInfo kInfo{
    .name = "added_mass",
    .title = "Added mass",
    .equation = "F = mass_kg a, moving with the grip beyond the force sensor (grasp, joint) or with the arm",
    .source = "I. Newton 1687; stylus and gimbal of Fu and Cavusoglu II-B hang there",
    .fingerprint = "force in proportion to the acceleration of the grip",
    .experiment = "excitation up to 60 Hz, or the same trial with a known mass added",
    .places = {Place::grasp, Place::joint, Place::arm},
    .parameters =
        {{"mass_kg", "kg", 0.0, 100.0, 0.05, "of what moves along", {Role::shape, 0.01, 0.1, 3, Scale::absolute}}},
    .search_places = {Place::grasp},
};

class AddedMass final : public Effect {
 public:
  AddedMass(Place place, std::span<const double> values) : Effect(kInfo, place, values) {}
  double added_mass_kg(double) const override { return value(0); }
  LinearElement linearise(const OperatingPoint&, const PortBase&) const override { return {.mass_kg = value(0)}; }
};

}  // namespace

EffectType added_mass_effect() {
  return effect_entry<AddedMass>(kInfo);
}

}  // namespace handloop::models
