// A controller of one's own, run on the simulated Phantom exactly as it would run on hardware: it sees joint angles and
// forces, and answers with a force.
#include <cstdio>

#include "control/controllers/controller.h"
#include "control/controllers/phantom_mechanism.h"
#include "device/loop.h"
#include "device/sim_device.h"
#include "io/scenario_file.h"

using namespace handloop;

// [controller]
// Honey: a force against the velocity, no wall anywhere.
class Honey final : public control::Controller {
 public:
  explicit Honey(double damping_Ns_per_m, double sample_time_s)
      : damping_(damping_Ns_per_m), sample_time_s_(sample_time_s) {}

  void reset() noexcept override { started_ = false; }

  control::ControllerOutput step(const control::ControllerInput& input) override {
    control::ControllerOutput output;
    output.feedforward_torque_Nm = input.mechanism.gravity_torque_Nm;
    if (started_) output.force_N = -damping_ * (input.mechanism.tip_m - last_m_) / sample_time_s_;
    last_m_ = input.mechanism.tip_m;
    started_ = true;
    return output;
  }

 private:
  double damping_, sample_time_s_;
  bool started_ = false;
  Eigen::Vector3d last_m_ = Eigen::Vector3d::Zero();
};
// [controller]

int main() {
  const auto scenario = io::default_scenario();  // as scenes/phantom_wall.toml
  device::SimDevice phantom(scenario);           // put a real device here and nothing else changes
  const auto mechanism = control::make_mechanism(scenario.device);
  Honey honey(2.0, scenario.loop.sample_time_s);

  device::LoopConfig config;
  config.delay_samples = scenario.loop.delay_samples;
  const Eigen::Vector3d pose(scenario.device.pose_rad.data());
  config.limits = device::safety_limits(scenario, mechanism->at(pose).tip_m);
  device::Loop loop(config, phantom.description(), *mechanism, honey);

  phantom.start();
  for (int sample = 0; sample <= 1000; ++sample) {
    const auto& record = loop.step(phantom);
    if (sample % 200 == 0) std::printf("%.1f s: tip at x = %7.2f mm\n", sample * 1e-3, 1e3 * record.tip_m.x());
  }
  phantom.stop();
  std::printf("fault: %s\n", loop.fault().fault == device::Fault::none ? "none" : "yes");
}
