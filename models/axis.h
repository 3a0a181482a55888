#pragma once

#include <array>
#include <string_view>

#include "models/errors.h"

namespace handloop::models {

/// Axes of the hand as the arm paper (Fu and Cavusoglu) names them. Everywhere a person meets an axis it is one of
/// these. The device frame differs (x fore-aft, y lateral, z up): arm x = device y, arm y = device z, arm z = device x.
enum class Axis { x = 0, y = 1, z = 2 };  // x left-right, y up-down, z forward-backward

inline constexpr std::array<Axis, 3> kAxes{Axis::x, Axis::y, Axis::z};

/// Lower-case name, "x", "y" or "z".
constexpr std::string_view axis_name(Axis axis) {
  return std::array{"x", "y", "z"}[static_cast<std::size_t>(axis)];
}

/// Row of the device frame (0 = x fore-aft, 1 = y lateral, 2 = z up) along which this axis lies; the sign is +1.
constexpr int device_row(Axis axis) {
  return std::array{1, 2, 0}[static_cast<std::size_t>(axis)];
}

/// Accepts "x", "y", "z" in either case. Throws InputError for anything else.
Axis parse_axis(std::string_view text);

}  // namespace handloop::models
