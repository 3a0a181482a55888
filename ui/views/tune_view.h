#pragma once

#include "ui/views/bench.h"

namespace handloop::ui {

/// The verdict in words, the margins, and the loop in three pictures: Nyquist, Bode, K-B map.
void tune_view(Bench& bench);

}  // namespace handloop::ui
