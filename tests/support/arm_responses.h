#pragma once

#include <cstdint>
#include <vector>

#include "identify/spectra.h"

namespace handloop::test {

/// Eq. (1) of random_arms() at the 57 frequencies of the arm paper (0.52 - 29.8 Hz), as if measured well.
std::vector<identify::FrequencyResponse> arms_as_responses(int axis, std::size_t count, std::uint64_t seed);

}  // namespace handloop::test
