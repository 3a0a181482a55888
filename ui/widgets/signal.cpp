#include "ui/widgets/signal.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "ui/traces/pixel_columns.h"
#include "ui/widgets/look.h"

namespace handloop::ui {

void draw_signal(const Plot& plot, const MinMaxRing& samples, double sample_time_s, double scale,
                 const Colour& colour) {
  const int columns = std::max(static_cast<int>(plot.right() - plot.left()), 2);
  const auto extremes = pixel_columns(samples, sample_time_s, plot.x().low, plot.x().high, columns);
  const auto height = [&](float value) {
    const double drawn = static_cast<double>(value) * scale;
    return plot.at(plot.x().low, plot.y().log ? std::max(std::abs(drawn), kSmallestOnLog) : drawn).y;
  };
  std::vector<ImVec2> points;
  points.reserve(2 * extremes.size());
  for (std::size_t i = 0; i < extremes.size(); ++i) {
    if (extremes[i].empty()) continue;
    const float x = plot.left() + static_cast<float>(i) + 0.5f;
    const float low = height(extremes[i].low), high = height(extremes[i].high);
    // from where the last column ended, the nearer end first
    const bool low_first = points.empty() || std::abs(points.back().y - low) < std::abs(points.back().y - high);
    points.push_back({x, low_first ? low : high});
    if (std::abs(high - low) > 0.5f) points.push_back({x, low_first ? high : low});
  }
  if (points.size() > 1)
    plot.draw()->AddPolyline(points.data(), static_cast<int>(points.size()), packed(colour), ImDrawFlags_None,
                             px(1.3f));
}

}  // namespace handloop::ui
