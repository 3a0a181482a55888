#include "device/encoder_watch.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "control/controllers/virtual_wall.h"
#include "device/fault_injection.h"
#include "tests/device/fake_plant.h"

/// A counter that fails on a free joint, where no force stands out.
namespace handloop::device {
namespace {

struct Seen {
  FaultEvent event;
  double after_s = 0.0;
  double most_force_N = 0.0;
};

struct Motion {
  double sway_N = 5.0;         ///< 23 to 27 mm about the rest: 0.25 to 0.42 m/s
  double wall_m = 1.0;         ///< out of reach
  double torque_factor = 1.0;  ///< of the torque constant the loop believes in
  double sensor_factor = 1.0;  ///< of the sensor's scale
};

/// A hand that sways on all axes, with a fault from half a second on, watched for 6 s.
Seen sway(std::string_view fault, const Motion& motion) {
  FakePlant plant;
  plant.push_N = 0.0;
  plant.sway_N = motion.sway_N;
  std::optional<FaultyDevice> faulty;
  if (!fault.empty()) faulty.emplace(plant, fault, 500);
  Device* device = &plant;
  if (faulty) device = &*faulty;
  FakeMechanism mechanism;
  control::VirtualWall::Settings settings;
  settings.plane_m = motion.wall_m;
  settings.gains = {700.0, 2.0, 100.0};
  control::VirtualWall wall(settings);
  DeviceDescription believed = plant.description();
  for (auto& torque : believed.torque_Nm_per_A) torque *= motion.torque_factor;
  for (auto& scale : believed.analog_N_per_V) scale *= motion.sensor_factor;
  LoopConfig config;
  config.states.against_model = false;  // which would find most of it first
  Loop loop(config, believed, mechanism, wall);
  device->start();
  for (int i = 0; i < 6000 && loop.fault().fault == Fault::none; ++i) loop.step(*device);
  const auto& event = loop.fault();
  return {event, static_cast<double>(event.sample) * 1e-3 - 0.5, plant.most_force_N};
}

class FreeJoint : public testing::TestWithParam<const char*> {};

TEST_P(FreeJoint, ACounterThatFailsIsFoundWithinASecondOfMotion) {
  const auto seen = sway(GetParam(), {});
  EXPECT_EQ(fault_name(seen.event.fault), "encoder_disagrees");
  EXPECT_LT(seen.after_s, 1.0);
  EXPECT_LT(seen.event.value, EncoderWatch::kLeastGain);
  RecordProperty("found_after_s", std::to_string(seen.after_s));
  RecordProperty("gain", std::to_string(seen.event.value));
}

INSTANTIATE_TEST_SUITE_P(Each, FreeJoint,
                         testing::Values("encoder_stuck_1", "encoder_stuck_2", "encoder_stuck_3", "encoder_inverted_1",
                                         "encoder_inverted_2", "encoder_inverted_3"),
                         [](const auto& tested) { return std::string(tested.param); });

TEST(EncoderWatch, AccusesNoGoodCounterInFreeMotionOrAtTheWall) {
  for (const double sway_N : {0.2, 1.0, 2.0, 4.0, 7.0}) {
    for (const double wall_m : {0.002, 1.0}) {
      for (const double torque : {0.9, 1.1}) {
        for (const double sensor : {0.97, 1.03}) {
          const auto seen = sway("", {sway_N, wall_m, torque, sensor});
          EXPECT_NE(fault_name(seen.event.fault), "encoder_disagrees")
              << sway_N << " N, wall at " << wall_m << " m, factors " << torque << " and " << sensor << ", at "
              << seen.after_s << " s: " << seen.event.value;
        }
      }
    }
  }
}

TEST(EncoderWatch, SaysNothingWhereTheMassIsUnknown) {
  EncoderWatch watch(3, 1e-3);
  control::MechanismState state = FakeMechanism().at(Eigen::Vector3d::Zero());
  state.mass_matrix_kg_m2.setZero();
  for (int k = 0; k < 2000; ++k) {
    EXPECT_EQ(
        watch.check(Eigen::Vector3d::Zero(), state, Eigen::Vector3d::Zero(), {2.0 * std::sin(0.01 * k), 0.0, 0.0}, 1)
            .fault,
        Fault::none);
  }
}

}  // namespace
}  // namespace handloop::device
