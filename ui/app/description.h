#pragma once

#include <string>

#include "ui/views/bench.h"
#include "ui/widgets/landmarks.h"

namespace handloop::ui {

/// What the panel shows, as JSON: the verdict, the gains, the state of loop and jobs, and where everything named is.
std::string description_of(const Bench& bench, const Landmarks& landmarks);

}  // namespace handloop::ui
