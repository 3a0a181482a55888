#pragma once

#include <string>
#include <vector>

#include "models/recording.h"

namespace handloop::identify {

/// What the signals themselves say about a recording of an arm, before anything is fitted. Throws InputError, naming
/// the recording, where a channel is constant, not finite, or by its size cannot be what it is taken for (millimetres
/// for metres, force and position exchanged). Returns one line for each doubt that does not forbid a fit: a channel
/// that stays at its extreme (a saturated sensor, or a force that was limited on purpose) and one that stands still for
/// long.
std::vector<std::string> check_recording(const models::Recording& recording);

}  // namespace handloop::identify
