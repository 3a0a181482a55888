#include "studies/seven_bar_simulation.h"

#include <cmath>

#include "control/controllers/force_amplifier.h"
#include "control/controllers/seven_bar_mechanism.h"
#include "device/live_loop.h"
#include "device/loop.h"
#include "device/seven_bar_device.h"

namespace handloop::studies {

models::SafetySettings no_limits() {
  models::SafetySettings limits;
  limits.velocity_limit_m_per_s = limits.acceleration_limit_m_per_s2 = 1e9;
  limits.workspace_radius_m = limits.energy_limit_J = 1e9;
  limits.joint_velocity_limit_rad_per_s = limits.joint_acceleration_limit_rad_per_s2 = 1e9;
  limits.contact_force_limit_N = limits.model_torque_limit_Nm = 1e9;
  return limits;
}

SevenBarTrace simulate(const SevenBarSimulation& what) {
  models::Scenario scenario = what.scenario;
  if (!what.guarded) scenario.safety = no_limits();
  device::SevenBarDevice device(scenario);
  if (what.muscle) device.plant().set_muscle_force(what.muscle);
  if (what.environment) device.plant().set_environment_force(what.environment);
  const control::SevenBarMechanism mechanism(control::seven_bar_of(scenario));
  auto controller = control::make_force_amplifier(scenario);
  const Eigen::Vector3d home = mechanism.at(device::pose_rad(scenario)).tip_m;
  device::Loop loop(device::loop_config(scenario, home), device.description(), mechanism, controller);

  SevenBarTrace trace;
  trace.sample_time_s = scenario.loop.sample_time_s * static_cast<double>(what.every);
  const auto steps = static_cast<std::uint64_t>(std::llround(what.duration_s / scenario.loop.sample_time_s));
  device.start();
  for (std::uint64_t k = 0; k < steps; ++k) {
    const double t = static_cast<double>(k) * scenario.loop.sample_time_s;
    if (what.desired) controller.disturb(what.desired(t));
    const auto& record = loop.step(device);
    if (record.fault != device::Fault::none) break;
    if (k % what.every != 0) continue;
    const auto truth = device.plant().truth();
    trace.t_s.push_back(t);
    for (std::size_t i = 0; i < 2; ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      trace.position_m[i].push_back(controller.position_m()[row]);
      trace.desired_m[i].push_back(controller.desired_m()[row]);
      trace.hand_N[i].push_back(-record.sensed_force_N[2 * row]);
      trace.environment_N[i].push_back(-record.environment_force_N[2 * row]);
      trace.muscle_N[i].push_back(truth.muscle_force_N[row]);
    }
  }
  trace.fault = loop.fault();
  return trace;
}

}  // namespace handloop::studies
