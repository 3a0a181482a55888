// A device of one's own: counts and codes of whatever boards you have, behind the interface that the loop knows. The
// loop, its safety and the controllers need not be told. Here the boards are three motors on a bench that exist in this
// file only; where a driver's calls go is marked.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "control/controllers/mechanism.h"
#include "control/controllers/virtual_wall.h"
#include "device/loop.h"
#include "device/scales.h"

using namespace handloop;

// [device]
class BenchDevice final : public device::Device {
 public:
  // Scales and signs that turn your counts and codes into units; constant during a session.
  BenchDevice() {
    description_.motor_count = 3;
    description_.analog_input_count = 0;                                         // no force sensor
    description_.encoder_rad_per_count.fill(2 * std::numbers::pi / (4 * 1024));  // 1024 lines, four edges each
    description_.transmission_ratio.fill(10);
    description_.torque_Nm_per_A.fill(0.03);
    description_.amplifier_A_per_V = 0.3;
    description_.current_limit_A = 3;
    description_.sample_time_s = 0.001;
  }

  std::string_view name() const override { return "bench"; }
  const device::DeviceDescription& description() const override { return description_; }

  // Open the driver, set counters to zero and every DAC to zero_code(); throw InputError where it is not there.
  void start() override {
    sample_ = 0;
    angle_rad_.fill(0);
    speed_rad_per_s_.fill(0);
    stop();
  }

  // Latch and read the counters. Never wait for anything but the board, never throw: a reading that could not be taken
  // has valid = false, and the loop decides what follows.
  device::Reading read() override {
    device::Reading reading;
    reading.sample = sample_;
    reading.time_ns = static_cast<std::int64_t>(sample_) * 1'000'000;
    for (std::size_t i = 0; i < description_.motor_count; ++i) {
      reading.encoder_counts[i] = static_cast<std::int32_t>(
          std::lround(angle_rad_[i] * description_.transmission_ratio[i] / description_.encoder_rad_per_count[i]));
    }
    reading.valid = true;
    return reading;
  }

  // Hand the codes to the DACs; they act until the next write. False where they did not arrive.
  bool write(const device::Command& command) override {
    codes_ = command.dac_codes;
    for (std::size_t i = 0; i < description_.motor_count; ++i) move(i);
    ++sample_;
    return true;
  }

  // Zero current, now, from wherever it is called.
  void stop() override { codes_.fill(device::zero_code(description_)); }

  // Real boards keep their own time, so that the loop is paced by the clock: false there.
  bool lock_step() const override { return true; }

  // Somebody turns the first axis.
  void turn(double speed_rad_per_s) { speed_rad_per_s_[0] = speed_rad_per_s; }

 private:
  device::DeviceDescription description_;
  std::uint64_t sample_ = 0;
  std::array<double, 3> angle_rad_{}, speed_rad_per_s_{};
  std::array<std::uint32_t, 3> codes_{};

  // In the place of hardware: an inertia with a little friction, over one sample of constant torque.
  void move(std::size_t i) {
    constexpr double kInertia_kg_m2 = 5e-3, kFriction_Nms_per_rad = 2e-3;
    const double torque_Nm = device::code_torque_Nm(description_, i, codes_[i]);
    speed_rad_per_s_[i] +=
        (torque_Nm - kFriction_Nms_per_rad * speed_rad_per_s_[i]) / kInertia_kg_m2 * description_.sample_time_s;
    angle_rad_[i] += speed_rad_per_s_[i] * description_.sample_time_s;
  }
};
// [device]

// [mechanism]
// Kinematics, as a controller knows them: three levers of 0.2 m that move the tip along x, y and z.
class Levers final : public control::Mechanism {
 public:
  control::MechanismState at(const Eigen::Vector3d& joint_rad) const noexcept override {
    control::MechanismState state;
    state.tip_m = 0.2 * joint_rad;
    state.jacobian = 0.2 * Eigen::Matrix3d::Identity();
    return state;
  }
  Eigen::Vector3d feedforward_bound_Nm() const noexcept override { return Eigen::Vector3d::Zero(); }
};
// [mechanism]

int main() {
  BenchDevice bench;
  const Levers levers;
  control::VirtualWall wall({.row = 0, .plane_m = 0.01, .gains = {.stiffness_N_per_m = 300, .damping_Ns_per_m = 2}});
  device::LoopConfig config;
  config.limits.force_N = 5;
  device::Loop loop(config, bench.description(), levers, wall);

  bench.start();
  bench.turn(1.0);  // 0.2 m/s towards the wall
  double deepest_m = 0;
  for (int sample = 0; sample < 300; ++sample) {
    const auto& record = loop.step(bench);
    deepest_m = std::max(deepest_m, record.tip_m.x() - 0.01);
    if (sample % 50 == 0)
      std::printf("%.2f s: tip at %6.2f mm, force %6.3f N\n", sample * 1e-3, 1e3 * record.tip_m.x(),
                  record.written_force_N.x());
  }
  bench.stop();
  std::printf("deepest in the wall: %.2f mm\nfault: %s\n", 1e3 * deepest_m,
              loop.fault().fault == device::Fault::none ? "none" : "yes");
}
