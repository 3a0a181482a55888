#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "ui/traces/min_max_ring.h"

namespace handloop::ui {

/// One channel over a stretch of time, a pair of extremes for each column of pixels: what is drawn is the same as if
/// every sample were, however many there are. Columns without samples are empty.
inline std::vector<MinMax> pixel_columns(const MinMaxRing& ring, double sample_time_s, double low_s, double high_s,
                                         int columns) {
  std::vector<MinMax> result(static_cast<std::size_t>(columns));
  const auto sample_at = [&](int column) {
    const double time = low_s + (high_s - low_s) * column / columns;
    return time <= 0.0 ? std::uint64_t{0} : static_cast<std::uint64_t>(std::ceil(time / sample_time_s - 1e-9));
  };
  std::uint64_t from = sample_at(0);
  for (int column = 0; column < columns; ++column) {
    const std::uint64_t to = sample_at(column + 1);
    result[static_cast<std::size_t>(column)] = ring.extremes(from, to);
    from = to;
  }
  return result;
}

}  // namespace handloop::ui
