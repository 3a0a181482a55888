#include "control/unstructured.h"

#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <numbers>
#include <vector>

#include "control/loop_function.h"

namespace handloop::control {

using Complex = std::complex<double>;

Complex faced_stiffness(const LoopPlant& plant, const LoopTiming& timing, const WallGains& gains, double w) {
  const double T = timing.sample_time_s, half = 0.5 * w * T;
  const Complex s(0, w);
  // (1 - e^{-sT})/(sT) = e^{-sT/2} sin(wT/2)/(wT/2)
  const Complex hold = std::polar(half > 0 ? std::sin(half) / half : 1.0, -w * T * (timing.delay_samples + 0.5));
  const double one_minus_a = -std::expm1(-2 * std::numbers::pi * timing.cutoff_Hz * T);
  const Complex delta = LoopFunction::delta_at(w * T).std();
  const Complex wall =
      gains.stiffness_N_per_m + gains.damping_Ns_per_m * one_minus_a / T * delta / (delta + one_minus_a);
  return (plant.tip_mass_kg * s + plant.tip_damping_Ns_per_m) * s + hold * wall;
}

UnstructuredPeak unstructured_peak(const LoopPlant& plant, const LoopTiming& timing, const WallGains& gains,
                                   const models::UncertaintyModel& uncertainty, double low_Hz, double high_Hz) {
  const auto size = [&](double log_f) {
    const double w = 2 * std::numbers::pi * std::exp(log_f);
    const Complex s(0, w), HD = models::compliance(*plant.arm, s) * faced_stiffness(plant, timing, gains, w);
    return std::abs(uncertainty(s) * HD / (1.0 + HD));
  };
  const double low = std::log(low_Hz), high = std::log(high_Hz);
  const int count = std::max(200, static_cast<int>(400 * (high - low)));
  std::vector<double> value(static_cast<std::size_t>(count) + 1);
  const auto at = [&](int i) { return low + (high - low) * i / count; };
  UnstructuredPeak best;
  const auto offer = [&](double log_f, double v) {
    if (v > best.peak) best = {v, std::exp(log_f)};
  };
  for (int i = 0; i <= count; ++i) value[static_cast<std::size_t>(i)] = size(at(i));
  offer(low, value.front());
  offer(high, value.back());
  for (int i = 1; i < count; ++i) {
    const auto k = static_cast<std::size_t>(i);
    if (value[k] < value[k - 1] || value[k] < value[k + 1] || value[k] < 0.9 * best.peak) continue;
    const auto [x, v] =
        boost::math::tools::brent_find_minima([&](double f) { return -size(f); }, at(i - 1), at(i + 1), 40);
    offer(x, -v);
  }
  return best;
}

}  // namespace handloop::control
