// An effect of one's own, used as those of the catalogue are: its force law, its linear stand-in, the margins of a wall
// behind an arm that has it, and the simulated Phantom in a hand that has it.
#include <array>
#include <cmath>
#include <cstdio>

#include "control/linear_plant.h"
#include "device/scales.h"
#include "device/sim_device.h"
#include "io/scenario_file.h"
#include "models/effects/describing_function.h"
#include "models/effects/entry.h"
#include "studies/scenario_loop.h"

using namespace handloop;

// [effect]
namespace handloop::models {
namespace {

// What is known before it has values. Names carry units: they are the keys of model files.
const EffectInfo kInfo{
    .name = "eddy_brake",
    .title = "Eddy-current brake",
    .equation = "F = 2 force_N (v/v_c) / (1 + (v/v_c)^2), v_c = critical_m_per_s",
    .source = "W. R. Smythe, Trans. AIEE 61 (1942) 681",
    .fingerprint = "damping that is strong in slow motion and fades in fast",
    .experiment = "repeat at three times the force: the damping falls",
    .places = {Place::arm, Place::joint},
    .parameters = {{"force_N", "N", 0.0, 1e4, 0.5, "largest force, reached at the critical speed"},
                   {"critical_m_per_s",
                    "m/s",
                    1e-4,
                    1e2,
                    0.1,
                    "speed of the largest force",
                    {.role = Role::shape, .from = 0.3, .to = 3, .points = 3, .scale = Scale::velocity}}},
    .search_places = {Place::arm},
};

class EddyBrake final : public Effect {
 public:
  EddyBrake(Place place, std::span<const double> values) : Effect(kInfo, place, values) {}

  // Resisting force: positive against positive motion. Real-time safe, and without state of its own.
  double force_N(const PortMotion& motion, const PortBase&, std::span<const double>) const override {
    return law(motion.v_m_per_s);
  }
  // What margins and fits see: the damper nearest to it for motion of this size.
  LinearElement linearise(const OperatingPoint& point, const PortBase&) const override {
    return {.damping_Ns_per_m = random_input_gain([this](double v) { return law(v); }, point.v_rms_m_per_s)};
  }

 private:
  double law(double v) const {
    const double ratio = v / value(1);
    return 2 * value(0) * ratio / (1 + ratio * ratio);
  }
};

}  // namespace

// The one function the catalogue asks every effect file for: <file name>_effect.
EffectType eddy_brake_effect() {
  return effect_entry<EddyBrake>(kInfo);
}

}  // namespace handloop::models
// [effect]

int main() {
  const std::array values{0.5, 0.1};  // force_N, critical_m_per_s
  const auto brake = models::eddy_brake_effect().make(models::Place::arm, values);

  for (const double speed : {0.01, 0.1, 1.0}) {
    models::OperatingPoint motion;
    motion.v_rms_m_per_s = speed;
    std::printf("%4.2f m/s: %.3f N; as a damper, moving at that rms: %.3f Ns/m\n", speed,
                brake->force_N({.v_m_per_s = speed}, {}, {}), brake->linearise(motion, {}).damping_Ns_per_m);
  }

  auto scenario = io::default_scenario();  // as scenes/phantom_wall.toml
  for (const bool braked : {false, true}) {
    if (braked) scenario.arm.effects.emplace_back(models::Axis::z, brake);

    const auto loop = studies::loop_of(scenario, models::Axis::z);
    models::AxisOperatingPoint motion;
    motion.arm = {.x_rms_m = 1e-3, .v_rms_m_per_s = 0.05};
    const auto margins =
        control::evaluate(studies::hand_model(scenario, models::Axis::z), motion, loop.plant.tip_mass_kg,
                          loop.plant.tip_damping_Ns_per_m, loop.timing, loop.gains);

    // How far a hand comes in 30 ms that is pulled with 1 N at most along z, the device's first axis.
    device::SimDevice phantom(scenario);
    phantom.start();
    phantom.pull({.anchor_m = {1, 0, 0}, .stiffness_N_per_m = 50, .limit_N = 1});
    device::Command idle;
    idle.dac_codes.fill(device::zero_code(phantom.description()));
    for (idle.sample = 0; idle.sample < 30; ++idle.sample) phantom.write(idle);
    std::printf("%s: gain margin %.3f; pulled with 1 N, after 30 ms %.2f mm\n",
                braked ? "with the brake" : "without it", margins.gain_up, 1e3 * phantom.plant().truth().tip_m[2]);
  }
}
