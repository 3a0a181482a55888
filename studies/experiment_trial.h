#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "device/device.h"
#include "models/scenario.h"
#include "studies/stimulus.h"

/// One trial of the arm paper's protocol on a device: a random force along one axis while the other axes are free,
/// gravity compensated. The device may be simulated or real.
namespace handloop::studies {

using DeviceFactory = std::function<std::unique_ptr<device::Device>(const models::Scenario&)>;

struct TrialPlan {
  models::Axis axis = models::Axis::x;
  StimulusKind stimulus = StimulusKind::noise;
  double rms_N = 0.0;  ///< 0: a third of the cap
  double highest_force_N = 5.0;
  double duration_s = 60.0;
  std::uint64_t seed = 1;  ///< of the stimulus
};

/// One sample a row. Force as the sensor gives it (positive: device on hand, along the axis); position of the grip
/// along the axis from the pose, by the encoders; command: force asked of the motors, held from this sample to the
/// next.
struct TrialRecord {
  double sample_time_s = 0.001;
  std::vector<double> force_N, position_m, grip_force_N, command_N;
  double cap_N = 0.0;  ///< 5 N, or what the motors' current limit leaves along the axis at the pose
  double stimulus_rms_N = 0.0;
  std::size_t clipped_samples = 0;
  int repeats = 0;  ///< at half the force each time, as the motion left the device's limits
};

/// Largest force along an axis that the motors can give either way at the pose beside what gravity takes, N.
double force_within_current_limit(const device::DeviceDescription& device, const models::DeviceSettings& settings,
                                  models::Axis axis);

/// Runs it, paced by the clock where the device is not in lock-step. The scenario says what the device is; its arm and
/// electronics matter where the device is simulated. Where the motion leaves the limits of speed, acceleration or
/// workspace, or the sensed force its own (a hand whose grasp hardly damps rings with the device's mass), a simulated
/// trial is repeated at half the force, as an experimenter would. Throws RequirementError where the run ended in
/// another fault.
TrialRecord record_trial(const TrialPlan& plan, const models::Scenario& scenario, const DeviceFactory& make_device);

/// `time_s,force_N,position_m,grip_force_N,command_N`.
std::string to_csv(const TrialRecord& record);

}  // namespace handloop::studies
