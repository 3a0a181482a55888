#pragma once

#include "tests/support/planted_recording.h"

namespace handloop::tests {

/// One of planted_axes(): a mass, spring and damper with what that kind of machine or joint has besides.
PlantedRecording plant_axis(std::string_view what, std::uint64_t seed, const PlantedOptions& options);

}  // namespace handloop::tests
