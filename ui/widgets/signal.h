#pragma once

#include "ui/traces/min_max_ring.h"
#include "ui/widgets/plot.h"

namespace handloop::ui {

/// Where logarithmic axes of signals begin, in drawn units.
inline constexpr double kSmallestOnLog = 1e-4;

/// A sampled signal over the plot's stretch of time (s from its first sample) as the envelope of each column of pixels;
/// where samples are sparser than pixels, as a line. Drawn is sample times scale; on a logarithmic axis its size.
void draw_signal(const Plot& plot, const MinMaxRing& samples, double sample_time_s, double scale, const Colour& colour);

}  // namespace handloop::ui
