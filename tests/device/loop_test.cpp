#include "device/loop.h"

#include <gtest/gtest.h>

#include <vector>

#include "control/controllers/virtual_wall.h"
#include "models/errors.h"
#include "tests/device/fake_plant.h"

namespace handloop::device {
namespace {

using control::VirtualWall;

VirtualWall::Settings wall_settings() {
  VirtualWall::Settings settings;
  settings.row = 0;
  settings.plane_m = 0.002;
  settings.gains = {500.0, 1.0, 100.0};
  return settings;
}

struct Rig {
  explicit Rig(int delay = 1, const VirtualWall::Settings& settings = wall_settings()) : wall(settings) {
    config.delay_samples = delay;
  }
  std::vector<StepRecord> run(int steps) {
    Loop loop(config, plant.description(), mechanism, wall);
    std::vector<StepRecord> records;
    plant.start();
    for (int i = 0; i < steps; ++i) records.push_back(loop.step(plant));
    return records;
  }
  FakeMechanism mechanism;
  FakePlant plant;
  VirtualWall wall;
  LoopConfig config;
};

TEST(Loop, HoldsTheHandAtTheWall) {
  Rig rig;
  const auto records = rig.run(3000);
  EXPECT_EQ(records.back().fault, Fault::none);
  // Balance of springs: push = hand_k x + K (x - plane); quantisation and half a DAC code are what is left.
  const double expected = (2.0 + 500.0 * 0.002) / (200.0 + 500.0);
  EXPECT_NEAR(rig.plant.position_m(0), expected, 3e-5);  // residual 1e-5
  EXPECT_TRUE(records.back().in_contact);
}

TEST(Loop, GravityCompensationCarriesTheLoad) {
  Rig rig;
  rig.run(2000);
  // Uncompensated the load of 0.05 Nm would hang 0.05 / 0.2 / 200 = 1.25 mm lower; half a DAC code is 5 micrometres.
  EXPECT_LT(std::abs(rig.plant.position_m(1)), 3e-5);
}

TEST(Loop, TheSameRunGivesTheSameBits) {
  Rig a, b;
  const auto first = a.run(1500), second = b.run(1500);
  for (std::size_t i = 0; i < first.size(); ++i) {
    ASSERT_EQ(first[i].reading, second[i].reading) << i;
    ASSERT_EQ(first[i].command, second[i].command) << i;
    ASSERT_EQ(first[i].energy_J, second[i].energy_J) << i;
  }
}

class LoopDelay : public testing::TestWithParam<int> {};

TEST_P(LoopDelay, WritesTheForceOfASampleThatManySamplesLater) {
  const int delay = GetParam();
  Rig rig(delay);
  // With a long delay the wall becomes unstable: the test is of the first samples, before any fault.
  const auto records = rig.run(100);
  const auto zero = zero_code(rig.plant.description());
  for (std::size_t i = 0; i < records.size(); ++i) {
    ASSERT_EQ(records[i].fault, Fault::none);
    if (i < static_cast<std::size_t>(delay)) {
      EXPECT_EQ(records[i].command.dac_codes[0], zero) << i;
    } else {
      const auto& then = records[i - static_cast<std::size_t>(delay)];
      EXPECT_EQ(records[i].written_force_N, then.limited_force_N) << i;
      EXPECT_EQ(records[i].command.dac_codes[0],
                torque_code(rig.plant.description(), 0, FakeMechanism::kLever_m * then.limited_force_N[0]))
          << i;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Delays, LoopDelay, testing::Values(0, 1, 2, 7, kMaxDelaySamples));

TEST(Loop, RefusesADelayItCannotHold) {
  EXPECT_THROW(Rig(-1).run(1), InputError);
  EXPECT_THROW(Rig(kMaxDelaySamples + 1).run(1), InputError);
}

TEST(Loop, ForceNeverExceedsTheLimitHoweverStiffTheWall) {
  auto settings = wall_settings();
  settings.gains = {1e6, 100.0, 400.0};
  Rig rig(1, settings);
  rig.config.limits.force_N = 3.0;
  rig.run(3000);
  // A DAC code is 4.9 mV * 0.3 A/V * 11.2 * 0.0234 Nm/A / 0.2 m = 1.9 mN on each of three axes.
  EXPECT_LE(rig.plant.most_force_N, 3.0 + 0.0035);
  EXPECT_GT(rig.plant.most_force_N, 2.9);
}

TEST(Loop, ForceChangesNoFasterThanTheRateLimit) {
  auto settings = wall_settings();
  settings.gains.stiffness_N_per_m = 1500.0;
  Rig rig(1, settings);
  rig.config.limits.force_rate_N_per_s = 100.0;
  const auto records = rig.run(1000);
  for (std::size_t i = 1; i < records.size(); ++i) {
    if (records[i].fault != Fault::none) break;
    ASSERT_LE((records[i].limited_force_N - records[i - 1].limited_force_N).norm(), 0.1 + 1e-12) << i;
  }
}

/// Adds an offset to counter 0, modulo 2^32.
class Folding final : public Device {
 public:
  Folding(Device& inner, std::uint32_t offset) : inner_(inner), offset_(offset) {}
  std::string_view name() const override { return "folding"; }
  const DeviceDescription& description() const override { return inner_.description(); }
  void start() override { inner_.start(); }
  Reading read() override {
    Reading r = inner_.read();
    r.encoder_counts[0] = static_cast<std::int32_t>(static_cast<std::uint32_t>(r.encoder_counts[0]) + offset_);
    return r;
  }
  bool write(const Command& c) override { return inner_.write(c); }
  void stop() override { inner_.stop(); }
  bool lock_step() const override { return true; }

 private:
  Device& inner_;
  std::uint32_t offset_;
};

TEST(Loop, CountersMayFoldWithoutANotice) {
  Rig rig;
  constexpr std::uint32_t kNearTheFold = 0x7ffffff0u;
  Folding folding(rig.plant, kNearTheFold);
  DeviceDescription description = rig.plant.description();
  description.encoder_zero_rad[0] =
      -static_cast<double>(kNearTheFold) * description.encoder_rad_per_count[0] / description.transmission_ratio[0];
  Loop loop(rig.config, description, rig.mechanism, rig.wall);
  folding.start();
  for (int i = 0; i < 2000; ++i) loop.step(folding);
  EXPECT_EQ(loop.fault().fault, Fault::none);
  EXPECT_GT(rig.plant.position_m(0), 3e-3);  // 3 mm are 60 counts: far beyond the fold
  EXPECT_NEAR(rig.plant.position_m(0), 3.0 / 700.0, 3e-5);
}

}  // namespace
}  // namespace handloop::device
