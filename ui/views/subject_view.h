#pragma once

#include "ui/views/bench.h"

namespace handloop::ui {

/// What the arm paper's subjects saw (Figure 2): crossbars, the target box, a cursor that follows the stylus and takes
/// the colour of the grip force, and the gauge.
void subject_view(Bench& bench);

}  // namespace handloop::ui
