#include "studies/time_domain.h"

#include <algorithm>
#include <cmath>

#include "control/controllers/phantom_mechanism.h"
#include "control/controllers/virtual_wall.h"
#include "device/scales.h"
#include "device/sim_device.h"

namespace handloop::studies {
namespace {

/// The push is to bend the wall by about 2.4 N: tens of encoder counts, and below the current limit. (With half of it
/// quantisation locks many decaying motions at the size they start with, and they cannot be told from undamped ones.) A
/// mass of about 0.12 kg (tip and grip) on the wall swings by J / sqrt(K m).
constexpr double kSwing_N = 2.4, kPush_N = 3.0, kMass_kg = 0.12;
constexpr double kLongestPush_s = 0.02;
constexpr double kWindow_s = 0.25;
constexpr int kMostWindows = 40;
constexpr int kLeastWindows = 4;
constexpr double kDiedOut = 1e-4, kGrown = 3.0;
/// Real electronics add motion of a few counts that never dies: what halves from a large swing is stable, what grows by
/// half, or to the current limit, is not.
constexpr double kHalved = 0.5, kGrownByHalf = 1.5;
constexpr double kQuiet_m = 1e-4;  // a few encoder counts at the tip

}  // namespace

models::Scenario still_scenario(models::Scenario scenario, models::Axis axis) {
  scenario.wall.axis = scenario.hand.axis = axis;
  scenario.wall.bilateral = true;
  scenario.wall.position_m = 0.0;
  scenario.hand.push_N = scenario.hand.disturbance_N = 0.0;
  scenario.arm.wander_rms_m = 0.0;
  return scenario;
}

TimeDomainLoop::TimeDomainLoop(const models::Scenario& scenario)
    : scenario_(still_scenario(scenario, scenario.wall.axis)),
      plant_(device::plant_scenario(scenario_)),
      description_(device::describe(plant_.description(), scenario_)),
      mechanism_(control::make_mechanism(scenario_.device)) {
  const Eigen::Vector3d pose(scenario_.device.pose_rad[0], scenario_.device.pose_rad[1], scenario_.device.pose_rad[2]);
  wall_ = std::make_unique<control::VirtualWall>(control::make_virtual_wall(scenario_, mechanism_->at(pose).tip_m));
  line_.resize(static_cast<std::size_t>(scenario_.loop.delay_samples) + 1);
}

TimeDomainLoop::~TimeDomainLoop() = default;

/// One sample of the loop; false where a current met its limit.
bool TimeDomainLoop::sample(bool push) {
  const sim::PlantReading reading = plant_.read();
  std::array<std::int64_t, device::kMaxMotors> counts{};
  for (std::size_t i = 0; i < sim::kMotors; ++i) counts[i] = reading.encoder_counts[i];
  control::ControllerInput input;
  input.sample = reading.sample;
  input.joint_rad = device::joint_angles_rad(description_, counts);
  input.mechanism = mechanism_->at(input.joint_rad);
  control::ControllerOutput output = wall_->step(input);
  if (push) output.force_N[models::device_row(scenario_.wall.axis)] += kPush_N;
  const Eigen::Vector3d torque = input.mechanism.jacobian.transpose() * output.force_N + output.feedforward_torque_Nm;
  bool within = true;
  sim::PlantCommand& computed = line_[head_];
  for (std::size_t i = 0; i < sim::kMotors; ++i) {
    const double wanted = torque[static_cast<Eigen::Index>(i)];
    computed.dac_codes[i] = device::torque_code(description_, i, wanted);
    const double limit =
        description_.current_limit_A * description_.transmission_ratio[i] * description_.torque_Nm_per_A[i];
    within = within && std::abs(wanted) <= limit;
  }
  head_ = (head_ + 1) % line_.size();
  plant_.advance(line_[head_]);  // written delay_samples ago; with no delay the one just computed
  ++samples_;
  return within;
}

TimeDomainVerdict TimeDomainLoop::judge(double stiffness_N_per_m, double damping_Ns_per_m) {
  plant_.reset();
  wall_->set_gains({stiffness_N_per_m, damping_Ns_per_m, scenario_.loop.cutoff_Hz});
  wall_->reset();
  sim::PlantCommand idle;
  idle.dac_codes.fill(device::zero_code(description_));
  std::fill(line_.begin(), line_.end(), idle);
  head_ = 0;

  const auto axis = static_cast<std::size_t>(scenario_.wall.axis);
  const int window = std::max(8, static_cast<int>(std::lround(kWindow_s / scenario_.loop.sample_time_s)));
  const double push_s = kSwing_N * std::sqrt(kMass_kg / std::max(stiffness_N_per_m, 1.0)) / kPush_N;
  const int push =
      std::max(1, static_cast<int>(std::lround(std::min(push_s, kLongestPush_s) / scenario_.loop.sample_time_s)));
  std::array<double, kMostWindows> size{};
  TimeDomainVerdict verdict;
  for (int w = 0; w < kMostWindows; ++w) {
    double sum = 0, low = INFINITY, high = -INFINITY;
    bool at_limit = false;
    for (int i = 0; i < window; ++i) {
      const bool within = sample(w == 0 && i < push);
      const sim::PlantTruth truth = plant_.truth();
      ++verdict.samples;
      if (truth.diverged) {
        verdict.growth_per_sample = INFINITY;
        return verdict;
      }
      at_limit = at_limit || !within;
      sum += truth.tip_m_per_s[axis] * truth.tip_m_per_s[axis];
      low = std::min(low, truth.tip_m[axis]);
      high = std::max(high, truth.tip_m[axis]);
    }
    verdict.saturated = verdict.saturated || (at_limit && w > 0);
    const auto now = static_cast<std::size_t>(w);
    size[now] = std::sqrt(sum / window);
    verdict.swing_m = high - low;
    const std::size_t back = std::min<std::size_t>(now, 4);
    verdict.growth_per_sample =
        back > 0 ? std::pow(size[now] / std::max(size[now - back], 1e-300), 1.0 / (static_cast<double>(back) * window))
                 : 1.0;
    if (w > 0 && size[now] > kGrown * size[0]) return verdict;
    if (description_.ideal) {
      const bool falling = w + 1 >= kLeastWindows && size[now] < size[now - 1] && size[now - 1] < size[now - 2];
      verdict.stable = falling && size[now] < kDiedOut * size[0];
      if (verdict.stable) return verdict;
    } else if (w > 1) {  // the first two windows hold what dies at once, whatever the wall
      if (size[now] > kGrownByHalf * size[1] && verdict.swing_m > kQuiet_m) return verdict;
      if (at_limit && w + 1 >= 2 * kLeastWindows) return verdict;  // it rings at what the motors can give
      verdict.stable = size[now] < kHalved * size[1] || verdict.swing_m < kQuiet_m;
      if (verdict.stable) return verdict;
    }
  }
  // A last second that is locked to the counts says nothing; ten seconds from the first push do.
  verdict.stable = size[kMostWindows - 1] + size[kMostWindows - 2] < 2 * size[1];
  return verdict;
}

}  // namespace handloop::studies
