#pragma once

#include <Eigen/Core>

#include "device/device.h"

/// Between counts, codes and units. All real-time safe.
namespace handloop::device {

using Vector3 = Eigen::Vector3d;

/// Pole of a sampled first-order low-pass: y = pole y + (1 - pole) x.
double filter_pole(double cutoff_Hz, double sample_time_s);

/// DAC code nearest to 0 V, from above: half a code too high, as no code of an even number is exactly 0 V.
std::uint32_t zero_code(const DeviceDescription& description);

/// Joint angles in rad. Counts are taken as they are: see EncoderUnwrap where they may wrap.
Vector3 joint_angles_rad(const DeviceDescription& description, const std::array<std::int64_t, kMaxMotors>& counts);

/// Volts at an ADC input; code 0 is -range, the largest code +range.
double adc_volts(const DeviceDescription& description, std::uint32_t code);
/// Force of analog input `channel` in N.
double analog_N(const DeviceDescription& description, std::size_t channel, std::uint32_t code);

/// Inputs that make up the force: 3, or the number of gauges; the grip force is the next one.
std::size_t force_inputs(const DeviceDescription& description);
/// Force of the device on the hand in N, device frame (or the sensor's own axes: control::Mechanism::hand_force_N).
Vector3 sensed_force_N(const DeviceDescription& description, const std::array<std::uint32_t, kMaxAnalogInputs>& codes);
/// Force of the device on its environment in N, the sensor's own axes; zero where it is not measured.
Vector3 environment_force_N(const DeviceDescription& description,
                            const std::array<std::uint32_t, kMaxAnalogInputs>& codes);
/// Grip force in N; 0 where it is not measured.
double grip_force_N(const DeviceDescription& description, const std::array<std::uint32_t, kMaxAnalogInputs>& codes);

/// Volts of a DAC code and the code nearest to a voltage, clamped to what the converter has.
double dac_volts(const DeviceDescription& description, std::uint32_t code);
std::uint32_t dac_code(const DeviceDescription& description, double volts);

/// DAC code that makes joint `motor` feel a torque in Nm (through capstan, motor and amplifier), the current limited to
/// the amplifier's. A torque that is not finite gives the zero code.
std::uint32_t torque_code(const DeviceDescription& description, std::size_t motor, double joint_torque_Nm);
/// Joint torque in Nm that a DAC code asks for.
double code_torque_Nm(const DeviceDescription& description, std::size_t motor, std::uint32_t code);

/// Continues 32-bit counters over their fold: differences are taken modulo 2^32, so no position is lost as long as a
/// motor turns less than 2^31 counts in a sample.
class EncoderUnwrap {
 public:
  void reset() { started_ = false; }
  std::array<std::int64_t, kMaxMotors> update(const std::array<std::int32_t, kMaxMotors>& counts);

 private:
  bool started_ = false;
  std::array<std::int32_t, kMaxMotors> last_{};
  std::array<std::int64_t, kMaxMotors> total_{};
};

}  // namespace handloop::device
