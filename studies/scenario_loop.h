#pragma once

#include "control/loop.h"
#include "models/axis_model.h"
#include "models/scenario.h"

/// A scenario seen along one axis of the hand: the loop that margins are computed for.
namespace handloop::studies {

/// The hand of one axis as a model: arm or rigid hand, with its effects.
models::AxisModel hand_model(const models::Scenario& scenario, models::Axis axis);

/// Tip inertia and damping at the scenario's pose, its five-parameter arm (none where the hand is rigid or nobody
/// holds), timing and gains. Throws InputError for a device or a pose without a tip inertia.
control::Loop loop_of(const models::Scenario& scenario, models::Axis axis);

/// True where the loop about the plain arm is not the whole plant: effects, or a hand that is one with the stylus.
bool needs_linear_plant(const models::Scenario& scenario, models::Axis axis);

}  // namespace handloop::studies
