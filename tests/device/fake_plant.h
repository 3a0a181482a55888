#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "control/controllers/mechanism.h"
#include "device/device.h"
#include "device/loop.h"
#include "device/scales.h"

namespace handloop::device {

/// Three sliding joints with a lever of 0.2 m each: tip = 0.2 q, and a constant load on joint 2.
class FakeMechanism final : public control::Mechanism {
 public:
  static constexpr double kLever_m = 0.2, kMass_kg = 0.1;
  control::MechanismState at(const Eigen::Vector3d& q) const noexcept override {
    control::MechanismState state;
    state.tip_m = kLever_m * q;
    state.jacobian = kLever_m * Eigen::Matrix3d::Identity();
    state.gravity_torque_Nm = {0.0, 0.05, 0.0};
    state.mass_matrix_kg_m2 = kMass_kg * kLever_m * kLever_m * Eigen::Matrix3d::Identity();
    return state;
  }
  Eigen::Vector3d feedforward_bound_Nm() const noexcept override { return {0.0, 0.06, 0.0}; }
};

/// A mass held by a hand (spring and damper to a rest, and a push) on each of three axes, behind encoders, DAC and ADC.
/// Integrated at 1/50 of the sample by the symplectic Euler rule. One row is pushed, and all may sway.
class FakePlant final : public Device {
 public:
  double mass_kg = FakeMechanism::kMass_kg, hand_k = 200.0, hand_b = 3.0, push_N = 2.0;
  std::size_t push_row = 0;
  double sway_N = 0.0;  ///< of 1.5, 2 and 2.5 Hz on the three axes

  FakePlant() {
    description_.encoder_rad_per_count.fill(2.0 * std::numbers::pi / 4096.0);
    description_.transmission_ratio.fill(11.2);
    description_.torque_Nm_per_A.fill(0.0234);
    description_.amplifier_A_per_V = 0.3;
    description_.current_limit_A = 3.0;
    description_.analog_N_per_V.fill(1.7);
  }

  std::string_view name() const override { return "fake"; }
  const DeviceDescription& description() const override { return description_; }
  DeviceDescription& settings() { return description_; }
  void start() override {
    x_.fill(0.0);
    v_.fill(0.0);
    sample_ = 0;
    noise_ = 12345;
    stops = 0;
    most_force_N = 0.0;
  }
  Reading read() override {
    Reading reading;
    reading.valid = true;
    reading.sample = sample_;
    reading.time_ns = static_cast<std::int64_t>(sample_) * 1'000'000;
    for (std::size_t i = 0; i < 3; ++i) {
      const double q = x_[i] / FakeMechanism::kLever_m - description_.encoder_zero_rad[i];
      reading.encoder_counts[i] = static_cast<std::int32_t>(
          std::llround(q * description_.transmission_ratio[i] / description_.encoder_rad_per_count[i]));
      const double sensed = hand_k * x_[i] + hand_b * v_[i] - push(i) + 0.003 * noise();
      reading.adc_codes[i] = adc(sensed / description_.analog_N_per_V[i]);
    }
    reading.adc_codes[3] = adc(1.0 / description_.analog_N_per_V[3]);
    return reading;
  }
  bool write(const Command& command) override {
    last = command;
    ++sample_;
    constexpr int kSubsteps = 50;
    for (std::size_t i = 0; i < 3; ++i) {
      const double torque = code_torque_Nm(description_, i, command.dac_codes[i]);
      const double force = (torque - (i == 1 ? 0.05 : 0.0)) / FakeMechanism::kLever_m;
      force_N[i] = torque / FakeMechanism::kLever_m;
      for (int k = 0; k < kSubsteps; ++k) {
        const double a = (force + push(i) - hand_k * x_[i] - hand_b * v_[i]) / mass_kg;
        v_[i] += a * 1e-3 / kSubsteps;
        x_[i] += v_[i] * 1e-3 / kSubsteps;
      }
    }
    // What the hand can feel beyond the load that is being carried.
    const double carried = std::clamp(force_N[1], 0.0, 0.06 / FakeMechanism::kLever_m);
    most_force_N = std::max(most_force_N, std::hypot(force_N[0], force_N[1] - carried, force_N[2]));
    return true;
  }
  void stop() override {
    ++stops;
    last.dac_codes.fill(zero_code(description_));
  }
  bool lock_step() const override { return true; }

  double position_m(std::size_t i) const { return x_[i]; }
  void place(std::size_t i, double x_m) { x_[i] = x_m; }

  Command last;
  std::array<double, 3> force_N{};  ///< of the motors at the tip
  double most_force_N = 0.0;        ///< largest so far, the carried load aside
  int stops = 0;

 private:
  double push(std::size_t i) const {
    const double rate_Hz = 1.5 + 0.5 * static_cast<double>(i);
    const double phase = 2.0 * std::numbers::pi * rate_Hz * static_cast<double>(sample_) * 1e-3;
    return (i == push_row ? push_N : 0.0) + sway_N * std::sin(phase);
  }
  static std::uint32_t adc(double volts) {
    const double code = std::round((volts + 10.0) / 20.0 * 65535.0);
    return static_cast<std::uint32_t>(std::clamp(code, 0.0, 65535.0));
  }
  double noise() {
    noise_ = noise_ * 6364136223846793005ULL + 1442695040888963407ULL;
    return static_cast<double>(noise_ >> 40) / 8388608.0 - 1.0;
  }

  DeviceDescription description_;
  std::array<double, 3> x_{}, v_{};
  std::uint64_t sample_ = 0;
  std::uint64_t noise_ = 12345;
};

}  // namespace handloop::device
