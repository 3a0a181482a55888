#include "models/transducers.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace handloop::models {

double Encoder::resolution_rad() const {
  return 2 * std::numbers::pi / counts_per_rev;
}

std::int32_t Encoder::counts(double shaft_angle_rad) const {
  const double edges = std::floor(shaft_angle_rad / resolution_rad());
  constexpr double lowest = std::numeric_limits<std::int32_t>::min(),
                   highest = std::numeric_limits<std::int32_t>::max();
  if (std::isnan(edges)) return 0;
  return static_cast<std::int32_t>(std::clamp(edges, lowest, highest));
}

double Encoder::angle_rad(std::int32_t counts) const {
  return counts * resolution_rad();
}

std::uint32_t Converter::code(double volt) const {
  const double last = maximum_code();
  if (std::isnan(volt)) return maximum_code() / 2 + 1;
  // Halves are rounded up; at 0 V this is the code just above zero.
  return static_cast<std::uint32_t>(std::clamp(std::floor((volt + range_V) / step_V() + 0.5), 0.0, last));
}

double Converter::volt(std::uint32_t code) const {
  return -range_V + 2 * range_V * std::min(code, maximum_code()) / maximum_code();
}

double Amplifier::current_A(double volt) const {
  return std::clamp(gain_A_per_V * volt, -limit_A, limit_A);
}

}  // namespace handloop::models
