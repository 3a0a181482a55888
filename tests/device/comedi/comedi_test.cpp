#include <comedilib.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <thread>

#include "device/comedi/comedi_device.h"
#include "device/scales.h"
#include "models/errors.h"
#include "tests/device/comedi/stand_in.h"

namespace handloop::device::comedi {
namespace {

using comedi_stand_in::registers;
using namespace std::chrono_literals;
constexpr std::uint32_t kZero = 2048;

class ComediBoards : public testing::Test {
 protected:
  void SetUp() override { comedi_stand_in::power_up(); }
  static ComediDevice make() { return {ComediConfig{}, {0.0, 0.0, 0.0}, 1e-3}; }
  static bool motors_at_zero() {
    return registers().dac[0] == kZero && registers().dac[1] == kZero && registers().dac[2] == kZero;
  }
  static bool soon_at_zero() {
    for (int i = 0; i < 300 && !motors_at_zero(); ++i) std::this_thread::sleep_for(10ms);
    return motors_at_zero();
  }
};

Command push() {
  Command command;
  command.dac_codes = {2500, 1700, 3000};
  return command;
}

TEST_F(ComediBoards, MotorsAreAtZeroFromTheBeginning) {
  ASSERT_FALSE(motors_at_zero());
  auto device = make();
  EXPECT_TRUE(motors_at_zero());
}

TEST_F(ComediBoards, CountersCountQuadratureFromTheMiddleOfTheirRange) {
  auto device = make();
  device.start();
  for (const int counter : {2, 3, 4}) {
    const auto c = static_cast<std::size_t>(counter);
    EXPECT_TRUE(registers().armed[c]);
    EXPECT_EQ(registers().modes[c],
              NI_GPCT_COUNTING_MODE_QUADRATURE_X4_BITS | NI_GPCT_COUNTING_DIRECTION_HW_UP_DOWN_BITS);
    EXPECT_EQ(registers().counters[c], 0x80000000u);
  }
  EXPECT_FALSE(registers().armed[5]);
  EXPECT_EQ(device.read().encoder_counts, (std::array<std::int32_t, 3>{0, 0, 0}));
  registers().counters[2] = 0x80000000u + 100;
  registers().counters[3] = 0x80000000u - 7;
  registers().counters[4] = 0x7fffffffu;
  const Reading reading = device.read();
  EXPECT_TRUE(reading.valid);
  EXPECT_EQ(reading.encoder_counts, (std::array<std::int32_t, 3>{100, -7, -1}));
}

TEST_F(ComediBoards, FixedInputsOfThe660xAreNoFault) {
  auto device = make();
  EXPECT_NO_THROW(device.start());
  EXPECT_EQ(device.tolerated().size(), 6u);  // A and B of three counters
}

TEST_F(ComediBoards, ForceComesFromTheAdcAtTheChosenRangeAndReference) {
  auto device = make();
  device.start();
  registers().adc[0] = 65535;
  registers().adc[3] = 40000;
  const Reading reading = device.read();
  EXPECT_EQ(reading.adc_codes[0], 65535u);
  EXPECT_EQ(reading.adc_codes[3], 40000u);
  EXPECT_EQ(registers().adc_specs[1], static_cast<unsigned>(CR_PACK(1, 0, AREF_DIFF)));
  EXPECT_NEAR(sensed_force_N(device.description(), reading.adc_codes)[0], 17.0, 1e-9);
}

TEST_F(ComediBoards, CommandsReachTheirChannels) {
  ComediConfig config;
  config.motors.channels = {5, 1, 7};
  config.motors.range_V = 5.0;
  ComediDevice device(config, {0.0, 0.0, 0.0}, 1e-3);
  device.start();
  EXPECT_TRUE(device.write(push()));
  EXPECT_EQ(registers().dac[5], 2500u);
  EXPECT_EQ(registers().dac[1], 1700u);
  EXPECT_EQ(registers().dac[7], 3000u);
  EXPECT_EQ(registers().dac_specs[5], static_cast<unsigned>(CR_PACK(5, 1, AREF_GROUND)));
  device.stop();
  EXPECT_EQ(registers().dac[5], kZero);
}

TEST_F(ComediBoards, ACodeTheConverterDoesNotHaveBecomesZero) {
  auto device = make();
  device.start();
  Command command = push();
  command.dac_codes[1] = 70000;
  EXPECT_TRUE(device.write(command));
  EXPECT_EQ(registers().dac[1], kZero);
}

TEST_F(ComediBoards, SignsOfTheWiringReachTheScales) {
  const auto description = make().description();
  EXPECT_EQ(description.dac_bits, 12);
  EXPECT_EQ(description.adc_bits, 16);
  // Motors 2 and 3 turn the other way on this device: the same torque needs the mirrored code.
  const auto code = torque_code(description, 0, 0.1);
  EXPECT_GT(code, kZero);
  EXPECT_LT(torque_code(description, 1, 0.1), kZero);
}

TEST_F(ComediBoards, GaugesBecomeForceThroughTheCalibrationMatrix) {
  ComediConfig config;
  config.force.channels = {0, 1, 2, 3, 4, 5, 6};
  config.force.N_per_V.assign(7, 1.0);
  config.force.gauge_N_per_V = {{1, 0, 0, 0, 0, 2}, {0, 1, 0, -1, 0, 0}, {0, 0, 1, 0, 0.5, 0}};
  ComediDevice device(config, {0.0, 0.0, 0.0}, 1e-3);
  std::array<std::uint32_t, kMaxAnalogInputs> codes;
  for (std::size_t i = 0; i < codes.size(); ++i) codes[i] = static_cast<std::uint32_t>(33000 + 1000 * i);
  const auto volt = [&](std::size_t i) { return -10.0 + 20.0 * static_cast<double>(codes[i]) / 65535.0; };
  const auto force = sensed_force_N(device.description(), codes);
  EXPECT_NEAR(force[0], volt(0) + 2 * volt(5), 1e-12);
  EXPECT_NEAR(force[1], volt(1) - volt(3), 1e-12);
  EXPECT_NEAR(force[2], volt(2) + 0.5 * volt(4), 1e-12);
  EXPECT_NEAR(grip_force_N(device.description(), codes), volt(6), 1e-12);
}

TEST_F(ComediBoards, WhatIsMissingIsNamed) {
  const auto message = [](auto&& make_it) -> std::string {
    try {
      make_it();
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  registers().no_board[2] = true;
  EXPECT_NE(message([] { make(); }).find("/dev/comedi2"), std::string::npos);
  comedi_stand_in::power_up();
  registers().counters_missing = true;
  EXPECT_NE(message([] { make(); }).find("not a counter"), std::string::npos);
  comedi_stand_in::power_up();
  ComediConfig config;
  config.motors.range_V = 7.0;
  EXPECT_NE(message([&] { ComediDevice(config, {0, 0, 0}, 1e-3); }).find("-2.5 to 2.5"), std::string::npos);
  config = {};
  config.motors.channels = {0, 1, 8};
  EXPECT_NE(message([&] { ComediDevice(config, {0, 0, 0}, 1e-3); }).find("no number 8"), std::string::npos);
  config = {};
  config.encoders.subdevices = {2, 3, 12};
  EXPECT_NE(message([&] { ComediDevice(config, {0, 0, 0}, 1e-3); }).find("no number 12"), std::string::npos);
  registers().dac_write_fails = true;
  EXPECT_NE(message([] { make(); }).find("cannot be set to zero"), std::string::npos);
}

TEST_F(ComediBoards, CountersThatWillNotStartAreRefusedBeforeAnyForce) {
  for (auto* failure : {&registers().arm_fails, &registers().reset_fails}) {
    comedi_stand_in::power_up();
    auto device = make();
    *failure = true;
    EXPECT_THROW(device.start(), InputError);
    EXPECT_TRUE(motors_at_zero());
  }
}

TEST_F(ComediBoards, FailedReadsAreNotValidAndFailedWritesAreTold) {
  auto device = make();
  device.start();
  registers().counter_read_fails = true;
  EXPECT_FALSE(device.read().valid);
  registers().counter_read_fails = false;
  registers().adc_read_fails = true;
  EXPECT_FALSE(device.read().valid);
  registers().adc_read_fails = false;
  EXPECT_TRUE(device.read().valid);
  registers().dac_write_fails = true;
  EXPECT_FALSE(device.write(push()));
  registers().dac_write_fails = false;
  registers().partial_list = true;
  EXPECT_FALSE(device.write(push()));
}

TEST_F(ComediBoards, ZeroIsTriedAgainWhereABoardIsBusy) {
  auto device = make();
  device.start();
  device.write(push());
  registers().dac_writes_failing = 2;
  device.stop();
  EXPECT_TRUE(motors_at_zero());
}

TEST_F(ComediBoards, SampleNumbersFollowTheClockAndNeverRepeat) {
  auto device = make();
  device.start();
  const auto first = device.read().sample;
  const auto second = device.read().sample;
  EXPECT_GT(second, first);
  std::this_thread::sleep_for(30ms);
  EXPECT_GE(device.read().sample, first + 29);
}

/// Does something in a process of its own and waits for its end.
template <typename Work>
int in_process(Work work) {
  const pid_t child = fork();
  if (child == 0) {
    work();
    _exit(0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return status;
}

TEST_F(ComediBoards, AKilledControllerLeavesTheMotorsAtZero) {
  const int status = in_process([] {
    auto device = make();
    device.start();
    device.write(push());
    raise(SIGKILL);
  });
  ASSERT_TRUE(WIFSIGNALED(status));
  EXPECT_TRUE(soon_at_zero());
}

TEST_F(ComediBoards, ACrashLeavesTheMotorsAtZero) {
  in_process([] {
    auto device = make();
    device.start();
    device.write(push());
    std::signal(SIGABRT, SIG_DFL);
    abort();
  });
  EXPECT_TRUE(soon_at_zero());
}

TEST_F(ComediBoards, AControllerThatStandsStillLosesItsForce) {
  auto device = make();
  device.start();
  for (int i = 0; i < 5; ++i) {
    device.write(push());
    std::this_thread::sleep_for(1ms);
  }
  // Longer than the watchdog's 20 ms: as with a debugger, SIGSTOP or an endless loop.
  EXPECT_TRUE(soon_at_zero());
  EXPECT_GE(device.guardian_interventions(), 1u);
}

TEST_F(ComediBoards, EndingInOrderNeedsNoGuardian) {
  {
    auto device = make();
    device.start();
    const pid_t guardian = device.guardian_process();
    EXPECT_EQ(kill(guardian, 0), 0);
    EXPECT_EQ(device.guardian_interventions(), 0u);
  }
  EXPECT_TRUE(motors_at_zero());
}

TEST(ComediConfiguration, TheExampleOfTheGuideIsUnderstood) {
  const auto config = parse_comedi_config(R"(
[encoders]
board = "/dev/comedi0"
subdevices = [2, 3, 4]
signs = [1, -1, 1]
[motors]
board = "/dev/comedi2"
channels = [0, 1, 2]
range_V = 10
signs = [1, -1, -1]
amplifier_A_per_V = 0.3
[force]
present = false
[guardian]
watchdog_s = 0.05
)",
                                          "rig.toml");
  EXPECT_EQ(config.encoders.signs[1], -1);
  EXPECT_FALSE(config.force.present);
  EXPECT_EQ(config.watchdog_s, 0.05);
}

TEST(ComediConfiguration, MistakesAreNamedWithLineAndKey) {
  const auto message = [](std::string_view text) -> std::string {
    try {
      parse_comedi_config(text, "rig.toml");
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  };
  const auto says = [&](std::string_view text, std::string_view part) {
    EXPECT_NE(message(text).find(part), std::string::npos) << message(text);
  };
  says("[encoders]\nsubdevice = [2, 3, 4]\n", "rig.toml, line 2");
  says("[encoders]\nsubdevice = [2, 3, 4]\n", "subdevices");
  says("[encoders]\nsubdevices = [2, 3]\n", "three different counters");
  says("[encoders]\nsigns = [1, 2, 1]\n", "1 or -1");
  says("[motors]\ncurrent_limit_A = -3\n", "positive");
  says("[motors]\nrange_V = \"ten\"\n", "a finite number");
  says("[motors]\nrange_V = nan\n", "a finite number");
  says("[force]\nN_per_V = [1, 2]\n", "as long as channels");
  says("[force]\ngauge_N_per_V = [[1, 2], [1, 2]]\n", "three rows");
  says("[guardian]\nwatchdog_s = 10\n", "from 0.002 to 1");
  says("[motor]\n", "motors");
  says("[motors\n", "rig.toml, line 1");
  EXPECT_THROW(read_comedi_config("/does/not/exist.toml"), InputError);
}

}  // namespace
}  // namespace handloop::device::comedi
