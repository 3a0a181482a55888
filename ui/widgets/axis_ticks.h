#pragma once

#include <string>
#include <vector>

namespace handloop::ui {

/// Where an axis of a plot begins and ends.
struct AxisRange {
  double low = 0.0, high = 1.0;
  bool log = false;

  /// Share of the way from low to high, 0 to 1 inside; and back.
  double place_of(double value) const;
  double value_at(double place) const;
  bool operator==(const AxisRange&) const = default;
};

struct Tick {
  double value;
  std::string label;  ///< "" for a minor one
};

/// Round numbers inside the range, about `most` of them at most; on a logarithmic axis decades with their minor ticks.
std::vector<Tick> ticks_of(const AxisRange& range, int most);

/// A value with as many digits as a reader needs.
std::string short_number(double value);

/// The range about a centre (a share of it) stretched by a factor; logarithmic ones in decades.
AxisRange zoomed(const AxisRange& range, double centre_share, double factor);
/// Shifted by a share of its length.
AxisRange shifted(const AxisRange& range, double share);

}  // namespace handloop::ui
