#pragma once

#include <string>
#include <utility>
#include <vector>

#include "io/plot.h"
#include "models/scenario.h"

namespace handloop::studies {

/// The pictures of docs/stability.md, one for each notion, of a scenario's own loop: file name (without .svg) and plot.
/// Throws InputError as scenario_margins does; the scenario must have a five-parameter arm on the wall's axis.
std::vector<std::pair<std::string, io::Plot>> stability_figures(const models::Scenario& scenario);

/// Draws them into a directory. Throws InputError where it cannot be written.
void write_stability_figures(const models::Scenario& scenario, const std::string& directory);

}  // namespace handloop::studies
