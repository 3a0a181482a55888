#pragma once

#include "models/scenario.h"

namespace handloop::models {

/// What the device of a scenario is to the hand along one axis, at the scenario's pose and the other axes free: the m
/// and b of the plant 1/(m s^2 + b s + 1/H) that margins are computed for.
struct ScenarioTip {
  double mass_kg = 0.0;           ///< stylus and gimbal included
  double damping_Ns_per_m = 0.0;  ///< of the joints; friction and resonance are not in it
};

/// Throws InputError for a device or a pose that has none (seven-bar linkage; a singular pose).
ScenarioTip tip_of(const Scenario& scenario, Axis axis);

}  // namespace handloop::models
