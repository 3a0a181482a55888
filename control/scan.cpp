#include "control/scan.h"

#include <numbers>

namespace handloop::control {

void scan_sampled_loop(const LoopFunction& loop, const ClosedLoopPoles& poles, MarginCollector& collector) noexcept {
  const double T = loop.plant.sample_time_s, nyquist = std::numbers::pi / T;
  FrequencyGrid grid(1e-5 * nyquist, nyquist);
  grid.add_logarithmic(100);
  grid.add_even(100 + 40 * loop.delay);
  const auto crowd = [&](std::complex<double> z) {
    if (std::abs(z) > 0.5 && z.imag() > 0) {
      grid.add_resonance(std::arg(z) / T, std::max(std::abs(1 - std::abs(z)), 1e-12) / T);
    }
  };
  for (int i = 0; i < poles.count; ++i) crowd(poles.z[static_cast<std::size_t>(i)]);
  for (int i = 0; i < 2 * loop.plant.section_count; ++i)
    crowd(std::exp(loop.plant.poles[static_cast<std::size_t>(i)] * T));
  const auto response = [&](double w) {
    const auto v = loop.at<false>(LoopFunction::delta_at(w * T));
    return ResponsePoint{v.numerator.std(), v.denominator.std()};
  };
  scan_response(grid.sorted(), response, collector);
  for (const Cx delta : {Cx(0), Cx(-2)}) {
    const auto v = loop.at<false>(delta);
    const double frequency = delta.re == 0 ? 0.0 : nyquist;
    if (v.denominator.norm() > 0) collector.phase_crossing(v.loop().re, frequency);
    collector.distance(v.numerator.std(), v.denominator.std(), frequency);
  }
}

}  // namespace handloop::control
