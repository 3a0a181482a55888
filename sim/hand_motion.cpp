#include "sim/hand_motion.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace handloop::sim {
namespace {

constexpr double kSlowest_Hz = 0.03;
constexpr double kFastest_Hz = 0.35;
constexpr double kPushSetsIn_s = 0.5;

}  // namespace

HandMotion::HandMotion(const models::Scenario& scenario)
    : wanders_(scenario.arm.wander_rms_m > 0),
      amplitude_m_(scenario.arm.wander_rms_m * std::sqrt(2.0 / kSines)),
      axis_(scenario.hand.axis),
      push_N_(scenario.hand.push_N),
      disturbance_N_(scenario.hand.disturbance_N),
      noise_(scenario.run.seed, models::RandomStream::hand_motion, 0, 1.0 / scenario.loop.sample_time_s) {
  for (std::uint32_t axis = 0; axis < 3; ++axis) {
    const models::CounterRandom random(scenario.run.seed, models::RandomStream::wander, axis);
    for (int i = 0; i < kSines; ++i) {
      const auto u = random.uniforms(i);
      const double frequency = kSlowest_Hz + (kFastest_Hz - kSlowest_Hz) * (i + u[0]) / kSines;
      sines_[axis][i] = {2 * std::numbers::pi * frequency, 2 * std::numbers::pi * u[1]};
    }
  }
}

HandMotion::Rest HandMotion::rest(double t_s) const {
  Rest rest;
  if (!wanders_) return rest;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const auto& [rate, phase] : sines_[axis]) {
      rest.position_m[axis] += amplitude_m_ * (std::sin(rate * t_s + phase) - std::sin(phase));
      rest.velocity_m_per_s[axis] += amplitude_m_ * rate * std::cos(rate * t_s + phase);
    }
  }
  return rest;
}

void HandMotion::reset() {
  noise_.reset();
  start_N_ = end_N_ = 0.0;
}

double HandMotion::force_N(double t_s) {
  const double share = std::min(t_s / kPushSetsIn_s, 1.0);
  const double push = push_N_ * 0.5 * (1 - std::cos(std::numbers::pi * share));
  return push + (disturbance_N_ > 0 ? disturbance_N_ * noise_.next() : 0.0);
}

void HandMotion::next_sample(double t_start_s, double t_end_s) {
  start_N_ = t_start_s == 0 ? 0.0 : end_N_;
  end_N_ = force_N(t_end_s);
}

}  // namespace handloop::sim
