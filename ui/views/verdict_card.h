#pragma once

#include "ui/views/bench.h"

namespace handloop::ui {

/// STABLE or UNSTABLE first, then why, then the figures.
void verdict_card(Bench& bench);

}  // namespace handloop::ui
