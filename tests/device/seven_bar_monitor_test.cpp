#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "control/controllers/force_amplifier.h"
#include "control/controllers/phantom_mechanism.h"
#include "control/controllers/seven_bar_mechanism.h"
#include "control/controllers/virtual_wall.h"
#include "device/live_loop.h"
#include "device/loop.h"
#include "device/scales.h"
#include "device/seven_bar_device.h"
#include "device/sim_device.h"
#include "io/scenario_file.h"

/// Every limit of the state monitor, crossed by a fault on purpose, on both devices: what is latched, and how long the
/// motors still have a torque.
namespace handloop::device {
namespace {

constexpr double kFar = 1e9;
constexpr std::uint64_t kOnset = 800;

using SpoilReading = std::function<void(Reading&, const DeviceDescription&, double since_s)>;
using SpoilCommand = std::function<void(Command&, const DeviceDescription&)>;

/// A device that lies, or does not do what it is told, from sample kOnset on.
class Spoilt final : public Device {
 public:
  Spoilt(Device& inner, SpoilReading reading, SpoilCommand command)
      : inner_(inner), reading_(std::move(reading)), command_(std::move(command)) {}
  std::string_view name() const override { return inner_.name(); }
  const DeviceDescription& description() const override { return inner_.description(); }
  void start() override { inner_.start(); }
  Reading read() override {
    Reading r = inner_.read();
    sample_ = r.sample;
    if (reading_ && r.sample >= kOnset) {
      reading_(r, description(), static_cast<double>(r.sample - kOnset + 1) * description().sample_time_s);
    }
    return r;
  }
  bool write(const Command& command) override {
    Command c = command;
    if (command_ && sample_ >= kOnset) command_(c, description());
    return inner_.write(c);
  }
  void stop() override { inner_.stop(); }
  bool lock_step() const override { return true; }

 private:
  Device& inner_;
  SpoilReading reading_;
  SpoilCommand command_;
  std::uint64_t sample_ = 0;
};

void turn(Reading& r, const DeviceDescription& d, double joint_rad) {
  r.encoder_counts[0] +=
      static_cast<std::int32_t>(std::lround(joint_rad * d.transmission_ratio[0] / d.encoder_rad_per_count[0]));
}

/// A fault of which one limit alone knows: all others are far away.
struct Case {
  std::string_view name;
  Fault fault;
  std::function<void(models::SafetySettings&)> limit;
  SpoilReading reading;
  SpoilCommand command;
};

std::uint32_t top(int bits) {
  return static_cast<std::uint32_t>(std::ldexp(1.0, bits) - 1.0);
}

const Case kCases[] = {
    {"position", Fault::joint_position, [](auto&) {}, [](Reading& r, const auto& d, double) { turn(r, d, 4.0); }, {}},
    {"velocity",
     Fault::joint_velocity,
     [](auto& s) { s.joint_velocity_limit_rad_per_s = 3.0; },
     [](Reading& r, const auto& d, double t) { turn(r, d, 5.0 * t); },
     {}},
    {"acceleration",
     Fault::joint_acceleration,
     [](auto& s) { s.joint_acceleration_limit_rad_per_s2 = 500.0; },
     [](Reading& r, const auto& d, double t) { turn(r, d, 0.5 * 3000.0 * t * t); },
     {}},
    {"hand_force",
     Fault::contact_force,
     [](auto& s) { s.contact_force_limit_N = 12.0; },
     [](Reading& r, const auto& d, double) { r.adc_codes[0] = static_cast<std::uint32_t>(0.9 * top(d.adc_bits)); },
     {}},
    {"other_force",
     Fault::contact_force,
     [](auto& s) { s.contact_force_limit_N = 12.0; },
     [](Reading& r, const auto& d, double) { r.adc_codes[2] = static_cast<std::uint32_t>(0.99 * top(d.adc_bits)); },
     {}},
    {"sensor_against_model",
     Fault::model_mismatch,
     [](auto& s) { s.model_torque_limit_Nm = 0.22; },
     [](Reading& r, const auto& d, double) { r.adc_codes[0] = static_cast<std::uint32_t>(0.9 * top(d.adc_bits)); },
     {}},
    {"motor_against_model",
     Fault::model_mismatch,
     [](auto& s) { s.model_torque_limit_Nm = 0.22; },
     {},
     [](Command& c, const auto& d) { c.dac_codes[1] = top(d.dac_bits); }},
};

models::Scenario quiet(const char* file) {
  auto s = io::read_scenario(std::string(HANDLOOP_SOURCE_DIR) + "/scenes/" + file);
  s.safety = {.force_limit_N = s.safety.force_limit_N,
              .force_rate_limit_N_per_s = s.safety.force_rate_limit_N_per_s,
              .velocity_limit_m_per_s = kFar,
              .acceleration_limit_m_per_s2 = kFar,
              .workspace_radius_m = kFar,
              .energy_limit_J = kFar,
              .watchdog_samples = 20,
              .joint_velocity_limit_rad_per_s = kFar,
              .joint_acceleration_limit_rad_per_s2 = kFar,
              .contact_force_limit_N = kFar,
              .model_torque_limit_Nm = kFar};
  return s;
}

class StateMonitorLimits : public testing::TestWithParam<Case> {};

/// Runs on until well after the fault; returns the time from the first reading that can show it (a motor's fault: the
/// one after the command) until all torques are within half a DAC code.
double time_to_zero_torque_s(Loop& loop, Spoilt& device, const std::function<double()>& largest_torque_Nm,
                             double half_code_Nm, std::uint64_t first_shown) {
  const double T = device.description().sample_time_s;
  device.start();
  double zero_since = -1.0;
  for (std::uint64_t k = 0; k < kOnset + static_cast<std::uint64_t>(0.1 / T); ++k) {
    loop.step(device);
    // the torque of this sample has acted since its reading
    const bool zero = largest_torque_Nm() <= half_code_Nm * 1.01;
    if (!zero) zero_since = -1.0;
    if (zero && zero_since < 0 && k >= first_shown) zero_since = static_cast<double>(k - first_shown) * T;
  }
  return zero_since;
}

TEST_P(StateMonitorLimits, TakeTheTorqueFromTheSevenBarWithinTwoMilliseconds) {
  auto scenario = quiet("seven_bar.toml");
  GetParam().limit(scenario.safety);
  // Its forces are ten times those of the Phantom.
  for (auto* limit : {&scenario.safety.contact_force_limit_N, &scenario.safety.model_torque_limit_Nm}) {
    if (*limit < kFar) *limit *= 10.0;
  }
  SevenBarDevice plant(scenario);
  Spoilt device(plant, GetParam().reading, GetParam().command);
  const control::SevenBarMechanism mechanism(control::seven_bar_of(scenario));
  auto controller = control::make_force_amplifier(scenario);
  Loop loop(loop_config(scenario, mechanism.at(pose_rad(scenario)).tip_m), device.description(), mechanism, controller);
  const double half_code_Nm = code_torque_Nm(device.description(), 0, zero_code(device.description()));
  const bool command_fault = static_cast<bool>(GetParam().command);
  const double time_s = time_to_zero_torque_s(
      loop, device,
      [&] {
        const auto truth = plant.plant().truth();
        // a motor that does not listen keeps its torque: the one that does must not
        return command_fault ? std::abs(truth.torque_Nm[0]) : truth.torque_Nm.cwiseAbs().maxCoeff();
      },
      half_code_Nm, kOnset + (command_fault ? 1 : 0));
  EXPECT_EQ(fault_name(loop.fault().fault), fault_name(GetParam().fault));
  EXPECT_GE(loop.fault().sample, kOnset);
  RecordProperty("time_to_zero_torque_us", static_cast<int>(std::lround(1e6 * time_s)));
  EXPECT_GE(time_s, 0.0);
  EXPECT_LT(time_s, 2e-3);
}

TEST_P(StateMonitorLimits, TakeTheTorqueFromThePhantomWithinTwoMilliseconds) {
  auto scenario = quiet("phantom_wall.toml");
  GetParam().limit(scenario.safety);
  SimDevice plant(scenario);
  Spoilt device(plant, GetParam().reading, GetParam().command);
  const auto mechanism = control::make_mechanism(scenario.device);
  const Eigen::Vector3d home = mechanism->at(pose_rad(scenario)).tip_m;
  auto wall = control::make_virtual_wall(scenario, home);
  auto config = loop_config(scenario, home);
  config.limits.mismatch_force_N = config.limits.stuck_force_N = kFar;
  Loop loop(config, device.description(), *mechanism, wall);
  const auto& d = device.description();
  const double half_code_A = dac_volts(d, zero_code(d)) * d.amplifier_A_per_V;
  const bool command_fault = static_cast<bool>(GetParam().command);
  const double time_s = time_to_zero_torque_s(
      loop, device,
      [&] {
        const auto current = plant.plant().truth().motor_current_A;
        return command_fault ? std::max(std::abs(current[0]), std::abs(current[2]))
                             : std::max({std::abs(current[0]), std::abs(current[1]), std::abs(current[2])});
      },
      half_code_A, kOnset + (command_fault ? 1 : 0));
  EXPECT_EQ(fault_name(loop.fault().fault), fault_name(GetParam().fault));
  EXPECT_GE(loop.fault().sample, kOnset);
  RecordProperty("time_to_zero_torque_us", static_cast<int>(std::lround(1e6 * time_s)));
  EXPECT_GE(time_s, 0.0);
  EXPECT_LT(time_s, 2e-3);
}

INSTANTIATE_TEST_SUITE_P(Each, StateMonitorLimits, testing::ValuesIn(kCases),
                         [](const auto& tested) { return std::string(tested.param.name); });

TEST(StateMonitor, IsSilentWhereNothingIsWrong) {
  // The scenario's own limits, the hand at work for 3 s; how near it came is the margin against false alarms.
  const auto scenario = io::read_scenario(std::string(HANDLOOP_SOURCE_DIR) + "/scenes/seven_bar.toml");
  SevenBarDevice device(scenario);
  const control::SevenBarMechanism mechanism(control::seven_bar_of(scenario));
  auto controller = control::make_force_amplifier(scenario);
  Loop loop(loop_config(scenario, mechanism.at(pose_rad(scenario)).tip_m), device.description(), mechanism, controller);
  device.start();
  double largest_Nm = 0;
  for (int k = 0; k < 15000; ++k) {
    largest_Nm = std::max(largest_Nm, loop.step(device).model_torque_Nm.cwiseAbs().maxCoeff());
  }
  EXPECT_EQ(loop.fault().fault, Fault::none);
  RecordProperty("largest_unexplained_torque_mNm", static_cast<int>(1e3 * largest_Nm));
  EXPECT_LT(largest_Nm, 0.5 * scenario.safety.model_torque_limit_Nm);
}

}  // namespace
}  // namespace handloop::device
