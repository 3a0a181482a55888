#include <gtest/gtest.h>

#include <filesystem>
#include <limits>

#include "control/controllers/virtual_wall.h"
#include "device/fault_injection.h"
#include "device/session.h"
#include "models/errors.h"
#include "tests/device/fake_plant.h"

/// Whatever breaks, no force beyond the limit reaches the hand, the log holds every sample, and the motors end at zero.
namespace handloop::device {
namespace {

namespace fs = std::filesystem;
constexpr double kLimit_N = 4.0;
// DAC steps of three axes: 3.3 mN together. A gap in the commands cannot add to it.
constexpr double kQuantum_N = 0.0035;

/// Does not sleep: every cycle is on time.
class InstantClock final : public Clock {
 public:
  std::int64_t now_ns() noexcept override { return now_; }
  void sleep_until(std::int64_t wake_ns) noexcept override { now_ = wake_ns; }

 private:
  std::int64_t now_ = 0;
};

struct Outcome {
  SessionResult result;
  std::uint64_t rows = 0;
  double most_force_N = 0.0;
  double end_force_N = 0.0;
  int stops = 0;
  bool start_threw = false;
  std::size_t evidence = 0;
};

/// A hand that sways through the wall, with a fault from sample 700 on.
Outcome run_with(control::Controller& controller, std::string_view fault, std::uint64_t from = 700) {
  FakePlant plant;
  plant.push_row = 2;
  plant.sway_N = 1.6;
  FaultyDevice device(plant, fault, from);
  FakeMechanism mechanism;
  LoopConfig config;
  config.limits.force_N = kLimit_N;
  config.limits.workspace_radius_m = 0.05;
  Loop loop(config, plant.description(), mechanism, controller);
  const fs::path path = fs::path(testing::TempDir()) / ("fault_" + std::string(fault) + ".csv");
  Outcome outcome;
  {
    LogFile log(path, {});
    DirectRecorder recorder(log);
    BlackBox box(2.0, 1e-3);
    InstantClock clock;
    SessionOptions options;
    options.steps = 3000;
    try {
      outcome.result = run_session(device, loop, recorder, box, clock, options);
    } catch (...) {
      outcome.start_threw = true;
    }
    outcome.rows = log.rows();
    outcome.evidence = box.size();
    recorder.finish();
  }
  fs::remove(path);
  outcome.most_force_N = plant.most_force_N;
  outcome.end_force_N = std::hypot(plant.force_N[0], plant.force_N[1], plant.force_N[2]);
  outcome.stops = plant.stops;
  return outcome;
}

control::VirtualWall::Settings wall_settings(int row = 0) {
  control::VirtualWall::Settings settings;
  settings.row = row;
  settings.plane_m = 0.002;
  settings.gains = {700.0, 2.0, 100.0};
  return settings;
}

class InjectedFaults : public testing::TestWithParam<std::string> {};

TEST_P(InjectedFaults, NeverEndInAForceOverTheLimitOrALostLog) {
  control::VirtualWall wall(wall_settings(2));
  const Outcome outcome = run_with(wall, GetParam());
  EXPECT_LE(outcome.most_force_N, kLimit_N + kQuantum_N);
  EXPECT_EQ(outcome.rows, outcome.result.steps);
  EXPECT_GE(outcome.stops, 1);
  if (outcome.start_threw) return;
  if (outcome.result.fault.fault == Fault::none) {
    EXPECT_EQ(outcome.result.steps, 3000u);
  } else {
    EXPECT_EQ(outcome.evidence, std::min<std::uint64_t>(outcome.result.steps, 2001u));
    // Long after the ramp only half a DAC code is left on each motor.
    if (GetParam() != "dac_held" && GetParam() != "write_fails" && GetParam() != "throw_on_write" &&
        GetParam() != "throw_unknown_on_write" && GetParam() != "dac_missing_bits") {
      EXPECT_LT(outcome.end_force_N, 0.01);
    }
  }
  RecordProperty("fault", std::string(fault_name(outcome.result.fault.fault)));
}

std::vector<std::string> fault_names() {
  std::vector<std::string> names;
  for (const auto& fault : injectable_faults()) names.emplace_back(fault.name);
  return names;
}

INSTANTIATE_TEST_SUITE_P(Each, InjectedFaults, testing::ValuesIn(fault_names()),
                         [](const auto& tested) { return tested.param; });

TEST(Faults, AtLeastFortyAreTried) {
  EXPECT_GE(injectable_faults().size(), 40u);
}

struct Expected {
  std::string_view injected;
  Fault fault;
};

class FoundFaults : public testing::TestWithParam<Expected> {};

TEST_P(FoundFaults, AreLatchedUnderTheirName) {
  control::VirtualWall wall(wall_settings(2));
  const Outcome outcome = run_with(wall, GetParam().injected);
  EXPECT_EQ(fault_name(outcome.result.fault.fault), fault_name(GetParam().fault));
}

INSTANTIATE_TEST_SUITE_P(
    Each, FoundFaults,
    testing::Values(
        Expected{"encoder_jump_large", Fault::encoder_jump}, Expected{"encoder_jump_small", Fault::encoder_jump},
        Expected{"encoder_random", Fault::encoder_jump}, Expected{"all_bits_set", Fault::encoder_jump},
        Expected{"encoder_shaking", Fault::model_mismatch}, Expected{"encoder_drift", Fault::workspace},
        Expected{"sensor_high", Fault::contact_force}, Expected{"sensor_low", Fault::contact_force},
        Expected{"sensor_out_of_range", Fault::contact_force}, Expected{"no_reading", Fault::no_reading},
        Expected{"reading_frozen", Fault::no_reading}, Expected{"sample_number_ahead", Fault::loop_stalled},
        Expected{"readings_200_late", Fault::loop_stalled}, Expected{"write_fails", Fault::write_failed},
        Expected{"throw_on_read", Fault::read_exception}, Expected{"throw_unknown_on_read", Fault::read_exception},
        Expected{"throw_on_write", Fault::write_exception}, Expected{"throw_unknown_on_write", Fault::write_exception}),
    [](const auto& tested) { return std::string(tested.param.injected); });

/// A controller that goes wrong at sample 700.
class BadController final : public control::Controller {
 public:
  enum class Way { nan_force, infinite_force, nan_torque, huge_force, huge_torque, throws, throws_unknown };
  explicit BadController(Way way) : way_(way) {}
  void reset() noexcept override {}
  control::ControllerOutput step(const control::ControllerInput& input) override {
    control::ControllerOutput output;
    output.feedforward_torque_Nm = input.mechanism.gravity_torque_Nm;
    if (input.sample < 700) return output;
    switch (way_) {
      case Way::nan_force:
        output.force_N[1] = std::nan("");
        break;
      case Way::infinite_force:
        output.force_N[0] = -std::numeric_limits<double>::infinity();
        break;
      case Way::nan_torque:
        output.feedforward_torque_Nm[2] = std::nan("");
        break;
      case Way::huge_force:
        output.force_N.setConstant(1e300);
        break;
      case Way::huge_torque:
        output.feedforward_torque_Nm.setConstant(1e6);
        break;
      case Way::throws:
        throw std::runtime_error("injected");
      case Way::throws_unknown:
        throw 42;
    }
    return output;
  }

 private:
  Way way_;
};

class BadControllers : public testing::TestWithParam<std::pair<BadController::Way, Fault>> {};

TEST_P(BadControllers, AreStoppedBeforeTheirForceIsFelt) {
  BadController controller(GetParam().first);
  FakePlant plant;
  FakeMechanism mechanism;
  LoopConfig config;
  config.limits.force_N = kLimit_N;
  Loop loop(config, plant.description(), mechanism, controller);
  plant.start();
  for (int i = 0; i < 1200; ++i) loop.step(plant);
  EXPECT_EQ(fault_name(loop.fault().fault), fault_name(GetParam().second));
  EXPECT_LE(plant.most_force_N, kLimit_N + kQuantum_N);
  if (loop.fault().fault == Fault::not_finite) {
    EXPECT_EQ(plant.last.dac_codes[0], zero_code(plant.description()));
  }
}

using Way = BadController::Way;
INSTANTIATE_TEST_SUITE_P(Each, BadControllers,
                         testing::Values(std::pair{Way::nan_force, Fault::not_finite},
                                         std::pair{Way::infinite_force, Fault::not_finite},
                                         std::pair{Way::nan_torque, Fault::not_finite},
                                         std::pair{Way::throws, Fault::controller_exception},
                                         std::pair{Way::throws_unknown, Fault::controller_exception}));

TEST(Faults, AHugeForceIsClippedToTheLimit) {
  BadController controller(Way::huge_force);
  FakePlant plant;
  plant.hand_b = 60.0;  // a hand that can take it
  FakeMechanism mechanism;
  LoopConfig config;
  config.limits.force_N = kLimit_N;
  Loop loop(config, plant.description(), mechanism, controller);
  plant.start();
  for (int i = 0; i < 800; ++i) loop.step(plant);
  EXPECT_LE(plant.most_force_N, kLimit_N + kQuantum_N);
  EXPECT_GT(loop.clipped_samples(), 90u);
}

TEST(Faults, FeedForwardCannotExceedWhatGravityNeeds) {
  BadController controller(Way::huge_torque);
  FakePlant plant;
  FakeMechanism mechanism;
  Loop loop({}, plant.description(), mechanism, controller);
  plant.start();
  for (int i = 0; i < 1200; ++i) {
    loop.step(plant);
    EXPECT_LE(std::abs(plant.force_N[1]), 0.06 / FakeMechanism::kLever_m + 0.002);
    EXPECT_LE(std::abs(plant.force_N[0]), 0.002);
  }
}

TEST(Faults, NanGivesZeroForceInTheSameSample) {
  BadController controller(Way::nan_force);
  FakePlant plant;
  FakeMechanism mechanism;
  Loop loop({}, plant.description(), mechanism, controller);
  plant.start();
  const auto zero = zero_code(plant.description());
  for (int i = 0; i <= 700; ++i) loop.step(plant);
  for (const auto code : plant.last.dac_codes) EXPECT_EQ(code, zero);
}

TEST(Faults, OthersRampToZeroAndNeverPushHarderMeanwhile) {
  control::VirtualWall wall(wall_settings());
  FakePlant plant;
  FakeMechanism mechanism;
  Loop loop({}, plant.description(), mechanism, wall);
  plant.start();
  for (int i = 0; i < 1000; ++i) loop.step(plant);
  const double before = std::abs(plant.force_N[0]);
  ASSERT_GT(before, 0.5);
  loop.trip(Fault::external);
  double last = before;
  for (int i = 0; i < 50; ++i) {
    loop.step(plant);
    EXPECT_LE(std::abs(plant.force_N[0]), last + 1e-12);
    // 50 ms for the whole force: at most 2 % a sample and a DAC code.
    EXPECT_GE(std::abs(plant.force_N[0]), last - before / 50 - 0.002);
    last = std::abs(plant.force_N[0]);
  }
  EXPECT_LT(last, 0.002);
}

TEST(Faults, StayLatchedUntilReset) {
  control::VirtualWall wall(wall_settings());
  FakePlant plant;
  FakeMechanism mechanism;
  Loop loop({}, plant.description(), mechanism, wall);
  plant.start();
  for (int i = 0; i < 500; ++i) loop.step(plant);
  loop.trip(Fault::external);
  for (int i = 0; i < 2000; ++i) loop.step(plant);
  EXPECT_EQ(loop.fault().fault, Fault::external);
  EXPECT_EQ(loop.fault().sample, 500u);
  EXPECT_EQ(plant.last.dac_codes[0], zero_code(plant.description()));
  loop.reset();
  for (int i = 0; i < 500; ++i) loop.step(plant);
  EXPECT_EQ(loop.fault().fault, Fault::none);
  EXPECT_NE(plant.last.dac_codes[0], zero_code(plant.description()));
}

TEST(Faults, AnUnknownInjectionSuggestsTheNearest) {
  EXPECT_EQ(parse_injection("throw_on_read@250").from_sample, 250u);
  try {
    parse_injection("trow_on_read");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("throw_on_read"), std::string::npos);
  }
  EXPECT_THROW(parse_injection("throw_on_read@x"), InputError);
}

}  // namespace
}  // namespace handloop::device
