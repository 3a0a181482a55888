#include "studies/seven_bar_measurement.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "control/controllers/seven_bar_mechanism.h"
#include "models/seven_bar.h"
#include "studies/seven_bar_simulation.h"

namespace handloop::studies {
namespace {

using Complex = std::complex<double>;
using Eigen::Vector2d;

constexpr double kPush_N = 8.0;
constexpr double kReach_m = 2e-3, kAcceleration_m_per_s2 = 2.0;  ///< of each line's motion, at most
constexpr double kShortSettle_s = 1.0;
constexpr double kCrossing_rad_per_s = 212.0;  ///< of the loop, as oscillations near its limit have it

struct Line {
  std::size_t axis;
  double frequency_rad_per_s;
  double phase_rad;
};

/// x on even and y on odd multiples of half the base frequency, phases spread so that peaks do not pile up.
std::vector<Line> lines_of(const PrimaryRequest& request) {
  const double base = 2 * std::numbers::pi / request.period_s;
  std::vector<Line> lines;
  for (std::size_t i = 0; i < request.frequencies_rad_per_s.size(); ++i) {
    const double multiple = std::max(1.0, std::round(request.frequencies_rad_per_s[i] / base));
    const auto n = static_cast<double>(i);
    lines.push_back({0, base * multiple, 2.4 * n * n});
    lines.push_back({1, base * (multiple + 1), 2.4 * n * n + 1.0});
  }
  return lines;
}

Vector2d excitation(const std::vector<Line>& lines, const std::vector<double>& amplitude, double t) {
  Vector2d sum = Vector2d::Zero();
  for (std::size_t i = 0; i < lines.size(); ++i) {
    sum[static_cast<Eigen::Index>(lines[i].axis)] +=
        amplitude[i] * std::sin(lines[i].frequency_rad_per_s * t + lines[i].phase_rad);
  }
  return sum;
}

/// Amplitude of one line over the last period of a signal.
Complex line_in(const std::vector<double>& signal, const SevenBarTrace& trace, const Line& line, double period_s) {
  const auto count = static_cast<std::size_t>(std::llround(period_s / trace.sample_time_s));
  Complex sum = 0;
  for (std::size_t k = signal.size() - count; k < signal.size(); ++k) {
    sum += signal[k] * std::exp(Complex(0, -line.frequency_rad_per_s * trace.t_s[k]));
  }
  return 2.0 * sum / static_cast<double>(count);
}

models::Scenario without_force_control(models::Scenario scenario) {
  scenario.force_amplifier.filter_numerator_m_per_N.fill(0.0);
  scenario.force_amplifier.hand = models::SevenBarHand::printed;
  scenario.force_amplifier.hand_leaves_s = 0.0;
  scenario.arm.attached = true;
  return scenario;
}

Vector2d nothing(double) {
  return Vector2d::Zero();
}

}  // namespace

std::vector<PrimaryPoint> measure_primary(const models::Scenario& scenario, const PrimaryRequest& request) {
  const auto lines = lines_of(request);
  const models::PrimaryLoop G;
  std::vector<double> way, push(lines.size(), kPush_N);
  for (const auto& line : lines) {
    const double w = line.frequency_rad_per_s;
    way.push_back(std::min(kReach_m, kAcceleration_m_per_s2 / (w * w)) / std::abs(G(Complex(0, w))));
  }
  SevenBarSimulation what;
  what.scenario = without_force_control(scenario);
  what.guarded = false;
  what.muscle = nothing;
  what.every = 2;
  what.duration_s = request.settle_s + request.period_s;
  what.desired = [&](double t) { return excitation(lines, way, t); };
  const auto commanded = simulate(what);

  std::vector<PrimaryPoint> points;
  const auto amplitude = [&](const SevenBarTrace& trace, const auto& signals, const Line& line) {
    return line_in(signals[line.axis], trace, line, request.period_s);
  };
  for (const auto& line : lines) {
    PrimaryPoint point;
    point.axis = line.axis;
    point.frequency_rad_per_s = line.frequency_rad_per_s;
    point.G = amplitude(commanded, commanded.position_m, line) / amplitude(commanded, commanded.desired_m, line);
    points.push_back(point);
  }
  if (!request.sensitivities) return points;

  what.desired = {};
  what.duration_s = kShortSettle_s + request.period_s;
  what.muscle = [&](double t) { return excitation(lines, push, t); };
  const auto pushed = simulate(what);
  const Vector2d th(scenario.device.pose_rad[0], scenario.device.pose_rad[1]);
  const Eigen::Matrix2d to_load = models::seven_bar_load_to_handle(control::seven_bar_of(scenario), th).inverse();
  what.muscle = nothing;
  what.environment = [&](double t) -> Vector2d { return to_load * excitation(lines, push, t); };
  const auto loaded = simulate(what);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    auto& point = points[i];
    point.S_h_m_per_N = amplitude(pushed, pushed.position_m, lines[i]) / amplitude(pushed, pushed.hand_N, lines[i]);
    point.G -= point.S_h_m_per_N * amplitude(commanded, commanded.hand_N, lines[i]) /
               amplitude(commanded, commanded.desired_m, lines[i]);
    const Complex force = kPush_N * std::exp(Complex(0, lines[i].phase_rad - std::numbers::pi / 2));
    point.S_e_m_per_N = (amplitude(loaded, loaded.position_m, lines[i]) -
                         point.S_h_m_per_N * amplitude(loaded, loaded.hand_N, lines[i])) /
                        force;
  }
  return points;
}

double simulated_growth_per_s(const models::Scenario& scenario, std::size_t axis) {
  SevenBarSimulation what;
  what.scenario = scenario;
  what.scenario.electronics.ideal = true;
  what.guarded = false;
  what.duration_s = 0.9;
  const auto row = static_cast<Eigen::Index>(axis);
  what.muscle = [row](double t) -> Vector2d { return (t < 0.004 ? 10.0 : 0.0) * Vector2d::Unit(row); };
  const auto trace = simulate(what);
  const auto& force = trace.hand_N[axis];
  // The oscillation alone, by a window that lets through some 20 rad/s about where the loop crosses: what is slower
  // (the hand) and faster (the solver's rounding) stays out.
  const auto size_over = [&](double from_s, double to_s) {
    Complex sum = 0;
    for (std::size_t k = 0; k < force.size(); ++k) {
      const double share = (trace.t_s[k] - from_s) / (to_s - from_s);
      if (share < 0 || share >= 1) continue;
      const double window = std::pow(std::sin(std::numbers::pi * share), 2);
      sum += window * force[k] * std::exp(Complex(0, -kCrossing_rad_per_s * trace.t_s[k]));
    }
    return std::abs(sum);
  };
  return std::log(size_over(0.5, 0.9) / size_over(0.1, 0.5)) / 0.4;
}

double simulated_alpha_limit(const models::Scenario& scenario, std::size_t axis, double near) {
  const auto growth = [&](double alpha) {
    models::Scenario changed = scenario;
    auto& f = changed.force_amplifier;
    (axis == 0 ? f.alpha_xx : f.alpha_yy) = {0, 0, 0, alpha};
    (axis == 0 ? f.alpha_yy : f.alpha_xx) = {0, 0, 0, 1};
    f.alpha_xy = f.alpha_yx = {};
    f.alpha_denominator = {0, 0, 0, 1};
    return simulated_growth_per_s(changed, axis);
  };
  double low = 0.96 * near, high = 1.04 * near;
  double at_low = growth(low), at_high = growth(high);
  // The secant of the rates: once to come close, once more to be there.
  const double between = low - at_low * (high - low) / (at_high - at_low);
  low = between;
  at_low = growth(low);
  return low - at_low * (high - low) / (at_high - at_low);
}

}  // namespace handloop::studies
