#pragma once

#include "ui/views/bench.h"

namespace handloop::ui {

/// Everything that can be turned: wall and controller, device, arm, effects, the hand's own motion.
void controls_view(Bench& bench);

}  // namespace handloop::ui
