#include "sim/seven_bar_plant.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "models/seven_bar.h"

namespace handloop::sim {
namespace {

using Eigen::Vector2d;

/// As scenes/seven_bar.toml has it, without a file: sim's tests read none.
models::Scenario linkage() {
  models::Scenario s;
  s.device.model = models::DeviceModel::seven_bar;
  s.device.pose_rad = {-std::numbers::pi / 2, 0.0, 0.0};
  s.loop.sample_time_s = 2e-4;
  s.run.physics_step_s = 1e-4;
  s.electronics.ideal = true;
  s.electronics.amplifier_A_per_V = 2.0;
  s.electronics.force_sensor_N_per_V = 20.0;
  s.force_amplifier.hand_rms_N = 0.0;
  return s;
}

PlantCommand torques(const PlantDescription& d, const Vector2d& Nm) {
  PlantCommand command;
  const double top = std::ldexp(1.0, d.dac_bits) - 1;
  command.dac_codes.fill(static_cast<std::uint32_t>(top / 2));
  for (std::size_t i = 0; i < 2; ++i) {
    const double volts = Nm[static_cast<Eigen::Index>(i)] / d.torque_Nm_per_A[i] / d.amplifier_A_per_V;
    command.dac_codes[i] = static_cast<std::uint32_t>(std::lround((volts / d.dac_range_V + 1) / 2 * top));
  }
  return command;
}

double volts(const PlantDescription& d, std::uint32_t code) {
  return d.adc_range_V * (2.0 * code / (std::ldexp(1.0, d.adc_bits) - 1) - 1.0);
}

Vector2d holding(double load_kg) {
  models::SevenBarParameters device;
  device.load_kg = load_kg;
  return models::seven_bar_gravity(models::seven_bar_inertia(device), models::seven_bar_home());
}

TEST(SevenBarPlant, StaysWhereItsWeightIsCarriedAndWeighsTheLoad) {
  auto scenario = linkage();
  SevenBarPlant plant(scenario);
  const auto command = torques(plant.description(), holding(scenario.force_amplifier.load_kg));
  for (int k = 0; k < 1000; ++k) plant.advance(command);
  EXPECT_LT(plant.truth().handle_m.norm(),
            2e-5);  // 5 um in 0.2 s, of the links' height that the closed form leaves out
  EXPECT_LT((plant.truth().environment_force_N - Vector2d(0, -33.82)).norm(), 0.05);
  const auto reading = plant.read();
  EXPECT_NEAR(volts(plant.description(), reading.adc_codes[3]) * plant.description().analog_N_per_V[3], 33.82, 0.05);
  EXPECT_NEAR(volts(plant.description(), reading.adc_codes[4]) * plant.description().analog_N_per_V[4], kSevenBarGrip_N,
              0.01);
}

TEST(SevenBarPlant, HandForceIsTheMuscleForceLessTheImpedance) {
  auto scenario = linkage();
  SevenBarPlant plant(scenario);
  plant.set_muscle_force([](double t) { return Vector2d(6 * std::sin(5 * t), 9 * std::sin(7 * t)); });
  const auto command = torques(plant.description(), holding(scenario.force_amplifier.load_kg));
  const models::HandImpedance H;
  Vector2d last_velocity = plant.truth().handle_m_per_s;
  double worst = 0;
  for (int k = 0; k < 2000; ++k) {
    const double t = plant.truth().t_s;
    const auto before = plant.truth();
    plant.advance(command);
    const auto now = plant.truth();
    const Vector2d acceleration = (now.handle_m_per_s - last_velocity) / 2e-4;
    last_velocity = now.handle_m_per_s;
    const Vector2d expected = Vector2d(6 * std::sin(5 * t), 9 * std::sin(7 * t)) - H.mass_kg * acceleration -
                              H.damping_Ns_per_m * before.handle_m_per_s - H.stiffness_N_per_m * before.handle_m;
    if (k > 20) worst = std::max(worst, (now.hand_force_N - expected).norm());
  }
  EXPECT_LT(worst, 0.02);  // N of up to 9; the mean over a sample against its end
}

TEST(SevenBarPlant, LoopsStayClosedUnderAHundredNewtons) {
  auto scenario = linkage();
  scenario.loop.sample_time_s = scenario.run.physics_step_s = 1e-3;  // at 1 kHz
  SevenBarPlant plant(scenario);
  plant.set_muscle_force([](double t) { return t < 0.05 ? Vector2d(0, 0) : Vector2d(70, -71); });
  double widest = 0;
  for (int k = 0; k < 400; ++k) {
    const auto truth = plant.truth();
    const Vector2d away = truth.joint_rad - models::seven_bar_home();
    const Vector2d torque = holding(scenario.force_amplifier.load_kg) - 600 * away - 40 * truth.joint_rad_per_s;
    plant.advance(torques(plant.description(), torque));
    widest = std::max(widest, truth.loop_gap_m);
  }
  EXPECT_LT(widest, 0.05e-3);
  EXPECT_FALSE(plant.truth().diverged);
}

TEST(SevenBarPlant, LimitSwitchesCutTheMotorBeforeTheStops) {
  auto scenario = linkage();
  scenario.arm.attached = false;
  SevenBarPlant plant(scenario);
  const models::SevenBarStops stops;
  bool cut = false;
  double highest = -2;
  for (int k = 0; k < 10000; ++k) {
    plant.advance(torques(plant.description(), {16.0, 20.4}));  // drives th3 forwards
    const auto truth = plant.truth();
    highest = std::max(highest, truth.joint_rad[0]);
    if (truth.switched_off[0]) {
      cut = true;
      EXPECT_EQ(truth.torque_Nm[0], 0.0);
      EXPECT_GT(truth.joint_rad[0], stops.upper_rad[0] - stops.switch_inside_rad - 1e-3);
    }
  }
  EXPECT_TRUE(cut);
  EXPECT_LT(highest, stops.upper_rad[0] + 0.05);  // the stop holds what comes to it
}

TEST(SevenBarPlant, NeuralFeedbackMakesALooseHandYield) {
  // Held still, the contact force of a loose hand is a quarter of what the command asks, once feedback has worked.
  for (const auto& [hand, share] : {std::pair{models::SevenBarHand::printed, 1.0},
                                    {models::SevenBarHand::tight, 1 / 1.2},
                                    {models::SevenBarHand::loose, 0.25}}) {
    auto scenario = linkage();
    scenario.force_amplifier.hand = hand;
    SevenBarPlant plant(scenario);
    plant.set_muscle_force([](double) { return Vector2d(0, 4.0); });
    const Vector2d home = models::seven_bar_home();
    for (int k = 0; k < 25000; ++k) {
      const auto truth = plant.truth();
      plant.advance(torques(plant.description(), holding(scenario.force_amplifier.load_kg) -
                                                     4000 * (truth.joint_rad - home) - 200 * truth.joint_rad_per_s));
    }
    // the arm's tissue takes a little away where the joint gives way
    EXPECT_NEAR(plant.truth().hand_force_N[1], 4.0 * share, 0.05) << models::hand_name(hand);
  }
}

TEST(SevenBarPlant, AHandThatLeavesTakesItsMassAndGripAway) {
  auto scenario = linkage();
  scenario.force_amplifier.hand_leaves_s = 0.1;
  SevenBarPlant plant(scenario);
  const auto command = torques(plant.description(), holding(scenario.force_amplifier.load_kg));
  for (int k = 0; k < 1000; ++k) plant.advance(command);
  EXPECT_FALSE(plant.truth().held);
  EXPECT_LT(plant.truth().hand_force_N.norm(), 1e-2);
  EXPECT_NEAR(volts(plant.description(), plant.read().adc_codes[4]), 0.0, 1e-3);
  plant.reset();
  EXPECT_TRUE(plant.truth().held);
}

}  // namespace
}  // namespace handloop::sim
