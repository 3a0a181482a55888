#include "studies/experiment_trial.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "control/controllers/phantom_mechanism.h"
#include "device/session.h"
#include "models/errors.h"

namespace handloop::studies {
namespace {

using Eigen::Vector3d;

/// Plays a force, and carries the device's weight.
class StimulusController final : public control::Controller {
 public:
  StimulusController(const std::vector<double>& force_N, int row) : force_N_(force_N), row_(row) {}
  void reset() noexcept override {}
  control::ControllerOutput step(const control::ControllerInput& input) override {
    control::ControllerOutput output;
    if (input.sample < force_N_.size()) output.force_N[row_] = force_N_[input.sample];
    output.feedforward_torque_Nm = input.mechanism.gravity_torque_Nm;
    return output;
  }

 private:
  const std::vector<double>& force_N_;
  int row_;
};

/// Keeps what a trial is about. The record's vectors have room for every sample: nothing allocates.
class TrialRecorder final : public device::Recorder {
 public:
  TrialRecorder(TrialRecord& record, std::size_t samples, int row, double home_m)
      : record_(record), row_(row), home_m_(home_m) {
    for (auto* column : {&record.force_N, &record.position_m, &record.grip_force_N, &record.command_N}) {
      column->reserve(samples);
    }
  }
  bool take(const device::StepRecord& step) noexcept override {
    if (record_.force_N.size() == record_.force_N.capacity()) return false;
    record_.force_N.push_back(step.sensed_force_N[row_]);
    record_.position_m.push_back(step.tip_m[row_] - home_m_);
    record_.grip_force_N.push_back(step.grip_force_N);
    record_.command_N.push_back(step.written_force_N[row_]);
    return true;
  }
  bool finish() noexcept override { return true; }

 private:
  TrialRecord& record_;
  int row_;
  double home_m_;
};

Vector3d pose_of(const models::DeviceSettings& settings) {
  return {settings.pose_rad[0], settings.pose_rad[1], settings.pose_rad[2]};
}

}  // namespace

double force_within_current_limit(const device::DeviceDescription& device, const models::DeviceSettings& settings,
                                  models::Axis axis) {
  const auto state = control::make_mechanism(settings)->at(pose_of(settings));
  const Vector3d torque_per_N = state.jacobian.row(models::device_row(axis)).transpose();
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 3; ++i) {
    const double limit = device.current_limit_A * std::abs(device.torque_Nm_per_A[i]) * device.transmission_ratio[i];
    const double left = limit - std::abs(state.gravity_torque_Nm[i]);
    if (std::abs(torque_per_N[i]) > 1e-9) least = std::min(least, left / std::abs(torque_per_N[i]));
  }
  return std::max(least, 0.0);
}

namespace {

constexpr int kMostRepeats = 6;

/// A gentler stimulus mends it: the arm and the device rang beyond what is permitted.
bool moved_too_far(device::Fault fault) {
  using device::Fault;
  switch (fault) {
    case Fault::velocity:
    case Fault::acceleration:
    case Fault::workspace:
    case Fault::encoder_jump:
    case Fault::joint_position:
    case Fault::joint_velocity:
    case Fault::joint_acceleration:
    case Fault::contact_force:
      return true;
    default:
      return false;
  }
}

/// One attempt. Fills the record; returns the fault that ended it.
device::SessionResult attempt(const TrialPlan& plan, const models::Scenario& scenario, device::Device& device,
                              TrialRecord& record) {
  const auto& description = device.description();
  const auto samples = static_cast<std::size_t>(std::llround(plan.duration_s / record.sample_time_s));
  StimulusSettings settings;
  settings.kind = plan.stimulus;
  settings.rms_N = record.stimulus_rms_N;
  settings.cap_N = record.cap_N;
  settings.sample_time_s = record.sample_time_s;
  const auto stimulus = make_stimulus(settings, samples, plan.seed);
  record.clipped_samples = stimulus.clipped_samples;

  const auto mechanism = control::make_mechanism(scenario.device);
  const Vector3d home = mechanism->at(pose_of(scenario.device)).tip_m;
  const int row = models::device_row(plan.axis);
  StimulusController controller(stimulus.force_N, row);
  device::LoopConfig config;
  config.limits = device::safety_limits(scenario, home);
  config.limits.force_N = plan.highest_force_N;
  config.limits.energy_J = std::numeric_limits<double>::infinity();  // a stimulus gives energy: that is its purpose
  // what the device's own mass takes or gives is no sign of a broken sensor
  config.limits.mismatch_force_N = 2 * plan.highest_force_N;
  config.delay_samples = 0;
  device::Loop loop(config, description, *mechanism, controller);
  TrialRecorder recorder(record, samples, row, home[row]);
  device::BlackBox black_box(0.01, record.sample_time_s);
  device::MonotonicClock clock;
  device::SessionOptions options;
  options.steps = samples;
  return device::run_session(device, loop, recorder, black_box, clock, options);
}

}  // namespace

TrialRecord record_trial(const TrialPlan& plan, const models::Scenario& scenario, const DeviceFactory& make_device) {
  const auto device = make_device(scenario);
  const double cap =
      std::min(plan.highest_force_N, force_within_current_limit(device->description(), scenario.device, plan.axis));
  double rms = plan.rms_N > 0 ? plan.rms_N : cap / 3;
  for (int repeats = 0;; ++repeats, rms /= 2) {
    TrialRecord record;
    record.sample_time_s = device->description().sample_time_s;
    record.cap_N = cap;
    record.stimulus_rms_N = rms;
    record.repeats = repeats;
    const auto result = attempt(plan, scenario, *device, record);
    if (result.fault.fault == device::Fault::none) return record;
    if (!moved_too_far(result.fault.fault) || !device->lock_step() || repeats == kMostRepeats) {
      throw RequirementError(
          fmt::format("the trial along {} ended after {:.3f} s with {}: {}", models::axis_name(plan.axis),
                      static_cast<double>(result.steps) * record.sample_time_s, device::fault_name(result.fault.fault),
                      device::fault_info(result.fault.fault).meaning));
    }
  }
}

std::string to_csv(const TrialRecord& record) {
  std::string text = "time_s,force_N,position_m,grip_force_N,command_N\n";
  text.reserve(64 * record.force_N.size());
  for (std::size_t i = 0; i < record.force_N.size(); ++i) {
    fmt::format_to(std::back_inserter(text), "{:.9g},{:.7g},{:.9g},{:.5g},{:.7g}\n",
                   static_cast<double>(i) * record.sample_time_s, record.force_N[i], record.position_m[i],
                   record.grip_force_N[i], record.command_N[i]);
  }
  return text;
}

}  // namespace handloop::studies
