#include <gtest/gtest.h>

#include <cstdlib>
#include <deque>

#include "control/loop.h"
#include "control/sampled_plant.h"
#include "control/stability_boundary.h"
#include "tests/sim/plant_loop.h"

/// The stiffness at which the simulated loop really goes unstable against the one that is predicted.
namespace handloop::sim {
namespace {

using namespace testing_support;
using Eigen::Vector3d;
using models::Axis;

constexpr double kJointDamping_Nms_per_rad = 0.0005;

/// Damping at the tip along an axis at the home pose, where each axis is one joint's: b / lever^2.
double tip_damping(const models::PhantomParameters& device, Axis axis) {
  const auto jacobian = models::phantom_jacobian(device, Vector3d::Zero());
  const double lever = jacobian.row(models::device_row(axis)).norm();
  return kJointDamping_Nms_per_rad / (lever * lever);
}

struct Wall {
  Axis axis;
  double damping_Ns_per_m;
  int delay_samples;
};

/// Bilateral spring and damper, closed over encoder counts and DAC codes so fine that nothing is lost; a small push in
/// the first 10 ms. True where the motion of the fourth second is larger than that of the second.
bool grows(const Wall& wall, double stiffness_N_per_m) {
  auto scenario = nominal_scenario();
  PhantomPlant plant(scenario);
  const auto device = models::phantom_parameters(scenario.device.parameter_set, scenario.device.stylus_mass_kg);
  const double home = models::phantom_tip(device, Vector3d::Zero())[models::device_row(wall.axis)];
  const double T = scenario.loop.sample_time_s, a = std::exp(-2 * std::numbers::pi * scenario.loop.cutoff_Hz * T);
  std::deque<PlantCommand> waiting;
  double last = 0, rate = 0, second = 0, fourth = 0;
  for (int k = 0; k < 4000; ++k) {
    const auto q = joint_angles(plant.description(), plant.read());
    const double x = models::phantom_tip(device, q)[models::device_row(wall.axis)] - home;
    rate = a * rate + (1 - a) / T * (k == 0 ? 0.0 : x - last);
    last = x;
    Vector3d force = Vector3d::Zero();
    force[models::device_row(wall.axis)] =
        -stiffness_N_per_m * x - wall.damping_Ns_per_m * rate + (k < 10 ? 0.02 : 0.0);
    const Vector3d torque =
        models::phantom_jacobian(device, q).transpose() * force + models::phantom_gravity(device, q);
    waiting.push_back(torque_command(plant.description(), torque));
    plant.advance(waiting.size() > static_cast<std::size_t>(wall.delay_samples)
                      ? waiting.front()
                      : torque_command(plant.description(), models::phantom_gravity(device, q)));
    if (waiting.size() > static_cast<std::size_t>(wall.delay_samples)) waiting.pop_front();
    const auto truth = plant.truth();
    if (truth.diverged || std::abs(x) > 0.01) return true;
    const double v = truth.tip_m_per_s[static_cast<std::size_t>(wall.axis)];
    if (k >= 1000 && k < 2000) second += v * v;
    if (k >= 3000) fourth += v * v;
  }
  return fourth > second;
}

double simulated_limit(const Wall& wall, double guess) {
  double low = 0.6 * guess, high = 1.6 * guess;
  EXPECT_FALSE(grows(wall, low));
  EXPECT_TRUE(grows(wall, high));
  while (high / low > 1.005) {
    const double middle = std::sqrt(low * high);
    (grows(wall, middle) ? high : low) = middle;
  }
  return std::sqrt(low * high);
}

double predicted_limit(const Wall& wall) {
  const auto device = models::phantom_parameters(models::PhantomParameterSet::cavusoglu, 0.052);
  control::LoopPlant plant;
  plant.tip_mass_kg = models::phantom_tip_inertia_kg(device, Vector3d::Zero(), wall.axis);
  plant.tip_damping_Ns_per_m = tip_damping(device, wall.axis);
  plant.arm = models::nominal_arm(wall.axis);
  control::LoopTiming timing;
  timing.delay_samples = wall.delay_samples;
  return control::critical_stiffness(control::sample_plant(plant, timing.sample_time_s), timing, wall.damping_Ns_per_m);
}

void expect_agreement(const Wall& wall) {
  const double predicted = predicted_limit(wall), simulated = simulated_limit(wall, predicted);
  if (std::getenv("HANDLOOP_RESIDUALS") != nullptr) {
    std::printf("axis %s, B %.1f, d %d: predicted %.1f, simulated %.1f N/m (%+.2f %%)\n",
                std::string(models::axis_name(wall.axis)).c_str(), wall.damping_Ns_per_m, wall.delay_samples, predicted,
                simulated, 100 * (simulated / predicted - 1));
  }
  EXPECT_NEAR(simulated / predicted, 1.0, 0.05) << "axis " << models::axis_name(wall.axis);
}

class CriticalGain : public testing::TestWithParam<Wall> {};

TEST_P(CriticalGain, OfTheSimulatedLoopIsThePredictedOne) {
  expect_agreement(GetParam());
}

INSTANTIATE_TEST_SUITE_P(EachAxis, CriticalGain,
                         testing::Values(Wall{Axis::x, 0.0, 1}, Wall{Axis::y, 0.0, 1}, Wall{Axis::z, 0.0, 1},
                                         Wall{Axis::x, 0.0, 0}, Wall{Axis::y, 1.0, 1}, Wall{Axis::z, 2.0, 2}),
                         [](const auto& at) {
                           return std::string(models::axis_name(at.param.axis)) + "_damping" +
                                  std::to_string(static_cast<int>(at.param.damping_Ns_per_m)) + "_delay" +
                                  std::to_string(at.param.delay_samples);
                         });

}  // namespace
}  // namespace handloop::sim
