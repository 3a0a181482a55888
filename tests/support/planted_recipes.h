#pragma once

#include <functional>
#include <map>
#include <string>
#include <string_view>

#include "tests/support/planted_plant.h"
#include "tests/support/planted_signals.h"

namespace handloop::tests {

/// How far the plant moves without any effect: what strengths are scaled by.
struct MotionScale {
  double force = 1.5, x = 5e-3, v = 0.1, grasp = 3e-3;
};

/// One effect, ready to be planted at any strength between lo and hi (its own unit).
struct Recipe {
  std::string name;
  std::string variant;
  double lo = 0, hi = 0;
  std::function<void(Plant&, double)> apply;
  std::function<std::map<std::string, double>(double)> parameters;
  bool tremor = false;
  double tremor_Hz = 8, tremor_bandwidth_Hz = 0.5;
};

/// Draws a way of writing the effect and everything about it but its strength. Throws std::invalid_argument for an
/// unknown name.
Recipe draw_recipe(std::string_view name, Draw& draw, const Plant& arm, const MotionScale& scale);

}  // namespace handloop::tests
