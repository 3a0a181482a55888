#include "sim/seven_bar_hand.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "models/random.h"

namespace handloop::sim {
namespace {

constexpr int kLines = 40;
constexpr double kSwell_s = 1.0;

}  // namespace

SevenBarHandModel::SevenBarHandModel(const models::Scenario& scenario, double step_s)
    : arm_(models::neural_arm(scenario.force_amplifier.hand)),
      cubic_N_per_m3_(scenario.force_amplifier.hand_cubic_N_per_m3),
      step_s_(step_s),
      neural_(scenario.force_amplifier.hand != models::SevenBarHand::printed) {
  const auto& f = scenario.force_amplifier;
  const models::CounterRandom random(scenario.run.seed, models::RandomStream::hand_motion, 10);
  const double highest = 2 * std::numbers::pi * f.hand_bandwidth_Hz;
  for (int i = 0; i < kLines; ++i) {
    // Somewhere within its own share of the band, so that nothing repeats.
    const auto u = random.uniforms(static_cast<std::uint64_t>(i));
    lines_.push_back({highest * (i + u[0]) / kLines, f.hand_rms_N * std::sqrt(2.0 / kLines),
                      2 * std::numbers::pi * u[1], 2 * std::numbers::pi * u[2]});
  }
  past_.resize(static_cast<std::size_t>(std::max(1.0, std::round(arm_.neural_delay_s / step_s))));
  reset();
}

void SevenBarHandModel::reset() noexcept {
  std::fill(past_.begin(), past_.end(), Eigen::Vector2d::Zero());
  newest_ = 0;
  feedback_N_.setZero();
  intended_N_.setZero();
}

Eigen::Vector2d SevenBarHandModel::irregular_force_N(double t_s) const noexcept {
  Eigen::Vector2d force = Eigen::Vector2d::Zero();
  for (const auto& line : lines_) {
    force[0] += line.amplitude_N * std::cos(line.frequency_rad_per_s * t_s + line.phase_x);
    force[1] += line.amplitude_N * std::cos(line.frequency_rad_per_s * t_s + line.phase_y);
  }
  const double swell = t_s < kSwell_s ? std::pow(std::sin(0.5 * std::numbers::pi * t_s / kSwell_s), 2) : 1.0;
  return swell * force;
}

Eigen::Vector2d SevenBarHandModel::step(const Eigen::Vector2d& muscle_N, const Eigen::Vector2d& contact_N,
                                        const Eigen::Vector2d& position_m,
                                        const Eigen::Vector2d& velocity_m_per_s) noexcept {
  if (neural_) {
    newest_ = (newest_ + 1) % past_.size();
    const Eigen::Vector2d late = past_[newest_];  // as old as the ring is long
    past_[newest_] = contact_N;
    // Both lags exactly, their inputs held over the step.
    const double keep = std::exp(-arm_.feedback_pole_rad_per_s * step_s_);
    feedback_N_ =
        keep * feedback_N_ + (1 - keep) * (arm_.feedback_gain_rad_per_s / arm_.feedback_pole_rad_per_s) * late;
    const double linger = std::exp(-step_s_ / arm_.activation_s);
    intended_N_ = linger * intended_N_ + (1 - linger) * (muscle_N - feedback_N_);
  } else {
    intended_N_ = muscle_N;
  }
  const Eigen::Vector2d cube = cubic_N_per_m3_ * position_m.array().cube();
  return intended_N_ - arm_.stiffness_N_per_m * position_m - arm_.damping_Ns_per_m * velocity_m_per_s - cube;
}

}  // namespace handloop::sim
