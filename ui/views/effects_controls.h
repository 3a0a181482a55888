#pragma once

#include "ui/views/bench.h"

namespace handloop::ui {

/// The effects on the wall's axis: their parameters, taking one away, adding one of the catalogue.
void effects_controls(Bench& bench);

}  // namespace handloop::ui
