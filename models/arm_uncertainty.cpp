#include "models/arm_uncertainty.h"

#include <array>
#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <numbers>
#include <string>

#include "models/errors.h"

namespace handloop::models {
namespace {

using Complex = std::complex<double>;

/// Table IV by axis, then set (max variance, 67 %), as printed.
const std::array<std::array<UncertaintyModel, 2>, 3> kPrinted{{
    {{{1.322,
       {{-3.420, 12.88}, {-67.28, 0.0024}, {-2.714, 6.183}, {-5.458, 27.34}, {-29.81, 159.5}},
       {{-2.294, 4.224}, {-53.48, 69.71}, {-54.64, 160.1}, {-1.971, 13.26}, {-4.536, 27.25}}},
      {0.4476,
       {{-68.65, 0.000}, {-2.349, 7.134}, {-54.65, 133.3}, {-6.627, 41.04}},
       {{-41.16, 0.0011}, {-8.028, 42.57}, {-4.297, 7.713}, {-43.17, 167.8}}}}},
    {{{1.856,
       {{-2.259, 7.250}, {-23.53, 129.2}, {-6.371, 39.57}, {-16.45, 92.46}, {-5.785, 30.96}},
       {{-56.82, 66.53}, {-19.90, 49.73}, {-3.334, 4.181}, {-19.81, 117.5}, {-2.908, 34.03}}},
      {1.163,
       {{-2.379, 8.072}, {-10.43, 18.00}, {-43.20, 99.69}, {-1547, 331.6}},
       {{-93.89, 128.0}, {-8.189, 0.000}, {-756.9, 1363}, {-6.038, 15.00}}}}},
    {{{2.592,
       {{-1.312, 6.482}, {-208.8, 0.5379}, {-20.09, 38.93}, {-5.210, 19.61}, {-5.004, 40.79}},
       {{-388.7, 18.74}, {-4.004, 17.33}, {-7.647, 49.51}, {-2.042, 6.189}, {-5.404, 35.032}}},
      {0.5320,
       {{-924.6, 122.0}, {-40.12, 84.57}, {-1.842, 6.803}, {-10.63, 39.00}, {-6.796, 95.29}},
       {{-13.19, 44.69}, {-2.594, 6.321}, {-73.98, 0.0048}, {-487.2, 964.86}, {-8.002, 5.687}}}}},
}};

std::array<std::array<UncertaintyModel, 2>, 3> corrected() {
  auto tables = kPrinted;
  tables[2][1].poles[4] = {-8.002, 95.687};
  return tables;
}

double magnitude_dB(const UncertaintyModel& model, double frequency_Hz) {
  return 20 * std::log10(std::abs(model(Complex(0, 2 * std::numbers::pi * frequency_Hz))));
}

}  // namespace

UncertaintySet parse_uncertainty_set(std::string_view text) {
  if (text == "max") return UncertaintySet::maximum;
  if (text == "67") return UncertaintySet::percentile67;
  throw InputError("unknown set '" + std::string(text) + "': give max (every subject) or 67 (67th percentile)");
}

std::string_view uncertainty_set_name(UncertaintySet set) {
  return set == UncertaintySet::maximum ? "max" : "67";
}

Complex UncertaintyModel::operator()(Complex s) const {
  Complex value = gain;
  // Zeros and poles alternate, so that no partial product runs out of range.
  for (std::size_t i = 0; i < std::max(zeros.size(), poles.size()); ++i) {
    if (i < zeros.size()) value *= (s - zeros[i]) * (s - std::conj(zeros[i]));
    if (i < poles.size()) value /= (s - poles[i]) * (s - std::conj(poles[i]));
  }
  return value;
}

const UncertaintyModel& uncertainty(Axis axis, UncertaintySet set) {
  static const auto tables = corrected();
  return tables[static_cast<std::size_t>(axis)][static_cast<std::size_t>(set)];
}

const UncertaintyModel& uncertainty_as_printed(Axis axis, UncertaintySet set) {
  return kPrinted[static_cast<std::size_t>(axis)][static_cast<std::size_t>(set)];
}

bool is_corrected(Axis axis, UncertaintySet set) {
  return axis == Axis::z && set == UncertaintySet::percentile67;
}

UncertaintyPeak peak(const UncertaintyModel& model, double low_Hz, double high_Hz) {
  constexpr int kPoints = 400;
  const double ratio = std::pow(high_Hz / low_Hz, 1.0 / kPoints);
  UncertaintyPeak best{low_Hz, magnitude_dB(model, low_Hz)};
  for (int i = 1; i <= kPoints; ++i) {
    const double frequency = i == kPoints ? high_Hz : low_Hz * std::pow(ratio, i);
    const double value = magnitude_dB(model, frequency);
    if (value > best.magnitude_dB) best = {frequency, value};
  }
  const auto refined = boost::math::tools::brent_find_minima([&](double f) { return -magnitude_dB(model, f); },
                                                             std::max(low_Hz, best.frequency_Hz / ratio),
                                                             std::min(high_Hz, best.frequency_Hz * ratio), 40);
  if (-refined.second > best.magnitude_dB) best = {refined.first, -refined.second};
  return best;
}

}  // namespace handloop::models
