#pragma once

#include <string>

#include "models/scenario.h"

namespace handloop::cli {

/// Reads the scenario a person named. A file that is not there but is one of ours ("scenes/phantom_wall.toml",
/// "phantom_wall.toml" or just "phantom_wall") is taken from where the scenes were installed, so that examples work in
/// any folder. "": the Phantom at a virtual wall. Throws InputError like io::read_scenario.
models::Scenario read_scenario_argument(const std::string& given);

}  // namespace handloop::cli
