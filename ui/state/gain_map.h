#pragma once

#include <cmath>

#include "control/stability_boundary.h"
#include "studies/tuning.h"

namespace handloop::ui {

/// A place in a plot's rectangle, 0 to 1 from its lower left corner.
struct PlotPlace {
  double x = 0.0, y = 0.0;
};

/// Gains at a place of the K-B map (stiffness to the right, damping upwards), rounded to what a hand on a mouse can
/// mean: a 500th of the window, to a round decimal step.
inline studies::GainPoint gains_at(const control::GainWindow& window, PlotPlace place) {
  const auto value = [](double low, double high, double share) {
    const double step = std::pow(10.0, std::floor(std::log10((high - low) / 100)));
    return std::max(low, std::min(high, step * std::round((low + (high - low) * share) / step)));
  };
  return {value(window.stiffness_low, window.stiffness_high, place.x),
          value(window.damping_low, window.damping_high, place.y)};
}

/// Whether a map still shows the gains with room about them; if not a new one is wanted.
inline bool shows(const control::GainWindow& window, double stiffness, double damping) {
  return stiffness <= 0.95 * window.stiffness_high && damping <= 0.95 * window.damping_high;
}

}  // namespace handloop::ui
