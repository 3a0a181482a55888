#include "ui/widgets/axis_ticks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace handloop::ui {

double AxisRange::place_of(double value) const {
  if (log) return (std::log10(std::max(value, 1e-300)) - std::log10(low)) / (std::log10(high) - std::log10(low));
  return (value - low) / (high - low);
}

double AxisRange::value_at(double place) const {
  if (log) return low * std::pow(high / low, place);
  return low + place * (high - low);
}

std::string short_number(double value) {
  if (value == 0.0) return "0";
  const double size = std::abs(value);
  if (size >= 1e5 || size < 1e-3) return fmt::format("{:.3g}", value);
  return fmt::format("{:.6g}", value);
}

std::vector<Tick> ticks_of(const AxisRange& range, int most) {
  std::vector<Tick> ticks;
  if (!(range.high > range.low) || !std::isfinite(range.low) || !std::isfinite(range.high)) return ticks;
  most = std::max(most, 2);
  if (range.log) {
    const int first = static_cast<int>(std::floor(std::log10(range.low)));
    const int last = static_cast<int>(std::ceil(std::log10(range.high)));
    const int every = std::max(1, (last - first + most - 1) / most);
    for (int decade = first; decade <= last; ++decade) {
      for (int i = 1; i < 10; ++i) {
        const double value = i * std::pow(10.0, decade);
        if (value < range.low * (1 - 1e-9) || value > range.high * (1 + 1e-9)) continue;
        const bool labelled = (i == 1 && decade % every == 0) || (last - first <= 2 && (i == 2 || i == 5));
        ticks.push_back({value, labelled ? short_number(value) : ""});
      }
    }
    return ticks;
  }
  const double raw = (range.high - range.low) / most;
  const double decade = std::pow(10.0, std::floor(std::log10(raw)));
  const double step = decade * (raw <= decade ? 1 : raw <= 2 * decade ? 2 : raw <= 5 * decade ? 5 : 10);
  for (double i = std::ceil(range.low / step - 1e-9); i * step <= range.high + 1e-9 * step; ++i) {
    const double value = std::abs(i) < 0.5 ? 0.0 : i * step;
    ticks.push_back({value, short_number(value)});
  }
  return ticks;
}

AxisRange zoomed(const AxisRange& range, double centre_share, double factor) {
  AxisRange result = range;
  result.low = range.value_at(centre_share - centre_share * factor);
  result.high = range.value_at(centre_share + (1 - centre_share) * factor);
  return result;
}

AxisRange shifted(const AxisRange& range, double share) {
  AxisRange result = range;
  result.low = range.value_at(share);
  result.high = range.value_at(1 + share);
  return result;
}

}  // namespace handloop::ui
