#pragma once

#include "models/scenario.h"

namespace handloop::sim {

/// How many physics steps make a sample: RunSettings::physics_step_s at most each, shorter where grasp, effects or
/// structure are faster than an explicit fourth-order step of that length follows. The linear arm behind the grasp does
/// not count: it is carried exactly. Throws InputError where the scenario is not possible.
int choose_substeps(const models::Scenario& scenario);

}  // namespace handloop::sim
