#include "device/scales.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace handloop::device {
namespace {

double largest_code(int bits) {
  return std::ldexp(1.0, bits) - 1.0;
}

}  // namespace

double filter_pole(double cutoff_Hz, double sample_time_s) {
  return std::exp(-2.0 * std::numbers::pi * cutoff_Hz * sample_time_s);
}

std::uint32_t zero_code(const DeviceDescription& description) {
  return dac_code(description, 0.0);
}

Vector3 joint_angles_rad(const DeviceDescription& d, const std::array<std::int64_t, kMaxMotors>& counts) {
  Vector3 q = Vector3::Zero();
  for (std::size_t i = 0; i < d.motor_count; ++i) {
    q[static_cast<Eigen::Index>(i)] =
        d.encoder_zero_rad[i] + static_cast<double>(counts[i]) * d.encoder_rad_per_count[i] / d.transmission_ratio[i];
  }
  return q;
}

double adc_volts(const DeviceDescription& d, std::uint32_t code) {
  return -d.adc_range_V + 2.0 * d.adc_range_V * static_cast<double>(code) / largest_code(d.adc_bits);
}

double analog_N(const DeviceDescription& d, std::size_t channel, std::uint32_t code) {
  return adc_volts(d, code) * d.analog_N_per_V[channel];
}

std::size_t force_inputs(const DeviceDescription& d) {
  return d.gauge_count > 0 ? d.gauge_count : std::min<std::size_t>(3, d.analog_input_count);
}

Vector3 sensed_force_N(const DeviceDescription& d, const std::array<std::uint32_t, kMaxAnalogInputs>& codes) {
  Vector3 force = Vector3::Zero();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    auto& along = force[static_cast<Eigen::Index>(axis)];
    if (d.gauge_count == 0) {
      if (axis < d.analog_input_count) along = analog_N(d, axis, codes[axis]);
      continue;
    }
    for (std::size_t i = 0; i < d.gauge_count; ++i) along += d.gauge_N_per_V[axis][i] * adc_volts(d, codes[i]);
  }
  return force;
}

Vector3 environment_force_N(const DeviceDescription& d, const std::array<std::uint32_t, kMaxAnalogInputs>& codes) {
  Vector3 force = Vector3::Zero();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::size_t i = 0; i < d.analog_input_count; ++i) {
      if (d.environment_N_per_V[axis][i] != 0.0) {
        force[static_cast<Eigen::Index>(axis)] += d.environment_N_per_V[axis][i] * adc_volts(d, codes[i]);
      }
    }
  }
  return force;
}

double grip_force_N(const DeviceDescription& d, const std::array<std::uint32_t, kMaxAnalogInputs>& codes) {
  const std::size_t input = force_inputs(d);
  return input < d.analog_input_count ? analog_N(d, input, codes[input]) : 0.0;
}

double dac_volts(const DeviceDescription& d, std::uint32_t code) {
  return -d.dac_range_V + 2.0 * d.dac_range_V * static_cast<double>(code) / largest_code(d.dac_bits);
}

std::uint32_t dac_code(const DeviceDescription& d, double volts) {
  const double top = largest_code(d.dac_bits);
  const double code = std::round((volts + d.dac_range_V) / (2.0 * d.dac_range_V) * top);
  return static_cast<std::uint32_t>(std::clamp(code, 0.0, top));
}

std::uint32_t torque_code(const DeviceDescription& d, std::size_t motor, double joint_torque_Nm) {
  if (!std::isfinite(joint_torque_Nm)) return zero_code(d);
  const double current_A = joint_torque_Nm / (d.transmission_ratio[motor] * d.torque_Nm_per_A[motor]);
  return dac_code(d, std::clamp(current_A, -d.current_limit_A, d.current_limit_A) / d.amplifier_A_per_V);
}

double code_torque_Nm(const DeviceDescription& d, std::size_t motor, std::uint32_t code) {
  const double current_A = std::clamp(dac_volts(d, code) * d.amplifier_A_per_V, -d.current_limit_A, d.current_limit_A);
  return current_A * d.transmission_ratio[motor] * d.torque_Nm_per_A[motor];
}

std::array<std::int64_t, kMaxMotors> EncoderUnwrap::update(const std::array<std::int32_t, kMaxMotors>& counts) {
  for (std::size_t i = 0; i < kMaxMotors; ++i) {
    if (!started_) {
      total_[i] = counts[i];
    } else {
      // Unsigned subtraction is modulo 2^32; read as signed it is the short way round.
      const auto difference = static_cast<std::uint32_t>(counts[i]) - static_cast<std::uint32_t>(last_[i]);
      total_[i] += static_cast<std::int32_t>(difference);
    }
    last_[i] = counts[i];
  }
  started_ = true;
  return total_;
}

}  // namespace handloop::device
