#pragma once

#include <cmath>

namespace handloop::ui {

/// The grip force that the subject's display names by colour: red for 1 N, cyan for 2 N, magenta for 3 N (Fu and
/// Cavusoglu, Figure 2). The paper does not say how near is near: within half a newton of the nearest, here.
enum class GripLabel { none, one_N, two_N, three_N };

inline GripLabel grip_label(double grip_force_N) {
  if (!(grip_force_N >= 0.5) || grip_force_N > 3.5) return GripLabel::none;
  return static_cast<GripLabel>(std::lround(grip_force_N - 1e-9));
}

}  // namespace handloop::ui
