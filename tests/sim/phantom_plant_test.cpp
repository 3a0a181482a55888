#include "sim/phantom_plant.h"

#include <gtest/gtest.h>

#include <bit>
#include <thread>

#include "tests/sim/plant_loop.h"

namespace handloop::sim {
namespace {

using namespace testing_support;
using Eigen::Vector3d;
using models::Axis;
using models::Place;

models::Scenario real_scenario() {
  auto scenario = nominal_scenario();
  scenario.electronics.ideal = false;
  return scenario;
}

Vector3d slow_force(std::size_t k) {
  const double t = 1e-3 * static_cast<double>(k);
  return {2.5 * std::sin(7 * t), 2 * std::sin(11 * t), 3 * std::sin(5 * t + 1)};
}

/// Everything a controller or log could see of a run, as bits.
std::vector<std::uint64_t> bits_of_run(const models::Scenario& scenario, std::size_t samples) {
  PhantomPlant plant(scenario);
  std::vector<std::uint64_t> bits;
  push_with(plant, scenario, samples, slow_force, [&](std::size_t, const PhantomPlant& at) {
    const auto reading = at.read();
    const auto truth = at.truth();
    for (const auto counts : reading.encoder_counts) bits.push_back(static_cast<std::uint64_t>(counts));
    for (const auto code : reading.adc_codes) bits.push_back(code);
    for (const double x : truth.tip_m) bits.push_back(std::bit_cast<std::uint64_t>(x));
    for (const double f : truth.hand_force_N) bits.push_back(std::bit_cast<std::uint64_t>(f));
  });
  return bits;
}

TEST(PhantomPlant, SameScenarioGivesTheSameBits) {
  const auto scenario = real_scenario();
  EXPECT_EQ(bits_of_run(scenario, 500), bits_of_run(scenario, 500));
}

TEST(PhantomPlant, ResetBringsBackTheFirstSampleToTheBit) {
  const auto scenario = real_scenario();
  PhantomPlant plant(scenario);
  const auto run = [&] {
    std::vector<double> x;
    push_with(plant, scenario, 300, slow_force,
              [&](std::size_t, const PhantomPlant& at) { x.push_back(at.truth().tip_m[2]); });
    return x;
  };
  const auto first = run();
  plant.reset();
  EXPECT_EQ(first, run());
}

TEST(PhantomPlant, PlantsInTwoThreadsDoNotDisturbEachOther) {
  auto one = real_scenario(), other = real_scenario();
  other.arm.axes[0].k1_N_per_m *= 2;
  other.run.seed = 7;
  const auto alone_one = bits_of_run(one, 400), alone_other = bits_of_run(other, 400);
  std::vector<std::uint64_t> together_one, together_other;
  {
    std::jthread a([&] { together_one = bits_of_run(one, 400); });
    std::jthread b([&] { together_other = bits_of_run(other, 400); });
  }
  EXPECT_EQ(together_one, alone_one);
  EXPECT_EQ(together_other, alone_other);
}

TEST(PhantomPlant, VisualsDoNotChangeTheBits) {
  const auto scenario = nominal_scenario();
  PhantomPlant bare(scenario), drawn(scenario, {.with_visuals = true});
  std::vector<double> x, y;
  push_with(bare, scenario, 200, slow_force,
            [&](std::size_t, const PhantomPlant& at) { x.push_back(at.truth().tip_m[0]); });
  for (int k = 0; k < 200; ++k) {
    y.push_back(drawn.truth().tip_m[0]);
    drawn.picture();
    push_with(
        drawn, scenario, 1, [&](std::size_t) { return slow_force(static_cast<std::size_t>(k)); },
        [](std::size_t, const PhantomPlant&) {});
  }
  EXPECT_EQ(x, y);
}

TEST(PhantomPlant, LoopStaysClosedUnderFiveNewtonsAlongEveryAxis) {
  for (const int axis : {0, 1, 2}) {
    const auto scenario = nominal_scenario();
    PhantomPlant plant(scenario);
    double widest = 0, farthest = 0;
    push_with(
        plant, scenario, 2000,
        [&](std::size_t k) {
          Vector3d force = Vector3d::Zero();
          force[axis] = k % 400 < 200 ? 5.0 : -5.0;  // full steps: worse than any stimulus
          return force;
        },
        [&](std::size_t, const PhantomPlant& at) {
          widest = std::max(widest, at.truth().loop_gap_m);
          farthest = std::max(farthest, std::abs(at.truth().tip_m[static_cast<std::size_t>(axis)]));
        });
    EXPECT_LT(widest, 0.05e-3);  // 0.6 um
    EXPECT_GT(farthest, 0.005);  // it did move
  }
}

TEST(PhantomPlant, EnergyNeitherAppearsNorVanishesWithoutDampersOrGravityWork) {
  auto scenario = nominal_scenario();
  scenario.device.joint_viscous_Nms_per_rad = 0.0;
  for (auto& arm : scenario.arm.axes) arm.b1_Ns_per_m = arm.b2_Ns_per_m = 0.0;
  PhantomPlant plant(scenario);
  const auto none = [](std::size_t, const PhantomPlant&) {};
  push_with(
      plant, scenario, 100, [](std::size_t k) { return Vector3d::Constant(k < 50 ? 0.5 : 0.0); }, none);
  const double before = plant.energy_J();
  push_with(
      plant, scenario, 5000, [](std::size_t) { return Vector3d::Zero(); }, none);
  // gravity compensation sees sampled angles: 0.3 % in 5 s and some forty swings of the grasp
  EXPECT_NEAR(plant.energy_J() / before, 1.0, 0.02);
  EXPECT_GT(before, 1e-4);
}

TEST(PhantomPlant, EnergyFallsWhenNobodyPushes) {
  const auto scenario = nominal_scenario();
  PhantomPlant plant(scenario);
  const auto none = [](std::size_t, const PhantomPlant&) {};
  push_with(
      plant, scenario, 100, [](std::size_t) { return Vector3d(1, 1, 1); }, none);
  double last = plant.energy_J();
  for (int i = 0; i < 20; ++i) {
    push_with(
        plant, scenario, 25, [](std::size_t) { return Vector3d::Zero(); }, none);
    const double now = plant.energy_J();
    EXPECT_LT(now, last + 1e-9);
    last = now;
  }
}

TEST(PhantomPlant, AShorterStepGivesTheSameMotion) {
  auto coarse = nominal_scenario(), fine = nominal_scenario();
  fine.run.physics_step_s = 5e-5;
  PhantomPlant a(coarse), b(fine);
  EXPECT_EQ(a.description().physics_step_s, 1e-3);
  EXPECT_NEAR(b.description().physics_step_s, 5e-5, 1e-12);
  std::vector<double> x, y;
  push_with(a, coarse, 1000, slow_force,
            [&](std::size_t, const PhantomPlant& at) { x.push_back(at.truth().tip_m[0]); });
  push_with(b, fine, 1000, slow_force, [&](std::size_t, const PhantomPlant& at) { y.push_back(at.truth().tip_m[0]); });
  double difference = 0, size = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    difference = std::max(difference, std::abs(x[i] - y[i]));
    size = std::max(size, std::abs(x[i]));
  }
  EXPECT_LT(difference, 1e-4 * size);
}

TEST(PhantomPlant, RestsWhereGravityIsCompensated) {
  const auto scenario = nominal_scenario();
  PhantomPlant plant(scenario);
  push_with(
      plant, scenario, 2000, [](std::size_t) { return Vector3d::Zero(); }, [](std::size_t, const PhantomPlant&) {});
  for (const double x : plant.truth().tip_m) EXPECT_NEAR(x, 0.0, 1e-6);
}

TEST(PhantomPlant, StandsStillUnderItsForceAsTheSpringsSay) {
  for (const int axis : {0, 1, 2}) {
    const auto scenario = nominal_scenario();
    PhantomPlant plant(scenario);
    Vector3d force = Vector3d::Zero();
    force[axis] = 1.0;
    push_with(
        plant, scenario, 4000, [&](std::size_t) { return force; }, [](std::size_t, const PhantomPlant&) {});
    const auto& arm = scenario.arm.axes[static_cast<std::size_t>(axis)];
    const double expected = 1 / arm.k1_N_per_m + 1 / arm.k2_N_per_m;
    // the pose moves a little and with it the other axes' share
    EXPECT_NEAR(plant.truth().tip_m[static_cast<std::size_t>(axis)] / expected, 1.0, 0.005);
    EXPECT_NEAR(plant.truth().hand_force_N[static_cast<std::size_t>(axis)], 1.0, 0.005);
  }
}

TEST(PhantomPlant, ReadsCountsOfTheEncodersAndCodesOfTheSensor) {
  const auto scenario = real_scenario();
  PhantomPlant plant(scenario);
  const auto& description = plant.description();
  push_with(plant, scenario, 1500, slow_force, [&](std::size_t, const PhantomPlant& at) {
    const auto truth = at.truth();
    const auto reading = at.read();
    const auto q = joint_angles(description, reading);
    for (int i = 0; i < 3; ++i) {
      const double resolution = description.encoder_rad_per_count[i] / description.transmission_ratio[i];
      EXPECT_LE(std::abs(q[i] - truth.joint_rad[i]), 0.5 * resolution * (1 + 1e-9));
    }
    for (const auto axis : models::kAxes) {
      const auto row = static_cast<std::size_t>(models::device_row(axis));
      const double volts = -description.adc_range_V + 2 * description.adc_range_V * reading.adc_codes[row] / 65535.0;
      // noise of 3 mN rms and half a code of 0.5 mN
      EXPECT_NEAR(volts * description.analog_N_per_V[row], truth.hand_force_N[static_cast<std::size_t>(axis)],
                  6 * 0.003);
    }
  });
}

TEST(PhantomPlant, LimitsTheCurrent) {
  const auto scenario = real_scenario();
  PhantomPlant plant(scenario);
  plant.advance(torque_command(plant.description(), Vector3d(10, -10, 0.1)));
  const auto current = plant.truth().motor_current_A;
  EXPECT_DOUBLE_EQ(current[0], 3.0);
  EXPECT_DOUBLE_EQ(current[1], -3.0);
  EXPECT_NEAR(current[2], 0.1 / (11.2 * 0.0234), 0.5 * 0.3 * 20 / 4095);  // within half a DAC code
}

TEST(PhantomPlant, GripSensorSpeaksSixtyFiveTimesASecond) {
  const auto scenario = real_scenario();
  PhantomPlant plant(scenario);
  int changes = 0;
  std::uint32_t last = plant.read().adc_codes[3];
  for (int k = 0; k < 2000; ++k) {
    plant.advance(torque_command(plant.description(), Vector3d::Zero()));
    const auto code = plant.read().adc_codes[3];
    changes += code != last;
    last = code;
  }
  EXPECT_NEAR(changes, 130, 4);  // neighbours may be the same code
}

TEST(PhantomPlant, FlangeFeelsTheStylusToo) {
  auto scenario = nominal_scenario();
  scenario.arm.force_sensed_at = models::ForceSensedAt::flange;
  PhantomPlant plant(scenario);
  std::vector<double> flange, hand, velocity;
  push_with(plant, scenario, 1000, slow_force, [&](std::size_t, const PhantomPlant& at) {
    const auto truth = at.truth();
    flange.push_back(truth.flange_force_N[0]);
    hand.push_back(truth.hand_force_N[0]);
    velocity.push_back(truth.tip_m_per_s[0]);
  });
  double error = 0, size = 0;
  for (std::size_t i = 400; i + 1 < flange.size(); ++i) {
    const double acceleration = (velocity[i + 1] - velocity[i - 1]) / 2e-3;
    error = std::max(error, std::abs(flange[i] - hand[i] - 0.052 * acceleration));
    size = std::max(size, std::abs(flange[i] - hand[i]));
  }
  EXPECT_LT(error, 0.05 * size);  // the difference quotient spans two holds of the motors
}

TEST(PhantomPlant, ElasticCapstanRingsAtItsFrequency) {
  auto scenario = nominal_scenario();
  scenario.arm.attached = false;
  scenario.device.structural_frequency_Hz = 60.0;
  scenario.device.structural_damping_ratio = 0.01;
  PhantomPlant plant(scenario);
  // motor 1 moves the turret alone: kick it and count how often its motion against a straight line changes sign
  std::vector<double> speed;
  push_with(
      plant, scenario, 1000, [](std::size_t k) { return Vector3d(k == 0 ? 1.0 : 0.0, 0, 0); },
      [&](std::size_t, const PhantomPlant& at) { speed.push_back(at.truth().joint_rad_per_s[0]); });
  double best = 0, at_Hz = 0;
  for (double f = 30; f < 120; f += 0.25) {
    const double size = std::abs(bin(speed, 10, f, 1e-3));
    if (size > best) {
      best = size;
      at_Hz = f;
    }
  }
  EXPECT_NEAR(at_Hz, 60.0, 1.5);
}

TEST(PhantomPlant, AForceBeyondReasonIsSaidToDiverge) {
  auto scenario = nominal_scenario();
  PhantomPlant plant(scenario);
  for (int k = 0; k < 3000 && !plant.truth().diverged; ++k) {
    plant.advance(torque_command(plant.description(), Vector3d::Constant(k % 2 == 0 ? 1e6 : -1e6)));
  }
  plant.advance(torque_command(plant.description(), Vector3d::Zero()));
  for (const double x : plant.truth().tip_m) EXPECT_TRUE(std::isfinite(x));
}

TEST(PhantomPlant, RefusesWhatCannotBe) {
  auto scenario = real_scenario();
  scenario.electronics.dac_bits = 40;
  EXPECT_THROW(PhantomPlant{scenario}, std::runtime_error);
  scenario = nominal_scenario();
  scenario.arm.axes[1].mass_kg = -1;
  EXPECT_THROW(PhantomPlant{scenario}, std::runtime_error);
  scenario = nominal_scenario();
  scenario.loop.sample_time_s = 0;
  EXPECT_THROW(PhantomPlant{scenario}, std::runtime_error);
}

}  // namespace
}  // namespace handloop::sim
