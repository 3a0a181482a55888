#pragma once

#include <array>
#include <cstdint>
#include <string_view>

/// A haptic device in hardware terms. The controller sees nothing else, so it cannot tell a simulation from the real thing.
namespace handloop::device {

inline constexpr std::size_t kMaxMotors = 3;
inline constexpr std::size_t kMaxAnalogInputs = 8;

/// What one sample reads. Counters and codes are raw, as the boards deliver them; scales live in DeviceDescription.
struct Reading {
  std::uint64_t sample = 0;                                    ///< counts from 0 in each session
  std::int64_t time_ns = 0;                                    ///< since the session's start; virtual in lock-step
  std::array<std::int32_t, kMaxMotors> encoder_counts{};       ///< wraps; differences are exact
  std::array<std::uint32_t, kMaxAnalogInputs> adc_codes{};     ///< offset binary, 0 .. 2^bits - 1
  bool valid = false;                                          ///< false: no fresh sample (late, lost, dead)
};

/// What one sample writes: DAC codes, offset binary. No code is exactly 0 V; kZero is the nearest above.
struct Command {
  std::uint64_t sample = 0;
  std::array<std::uint32_t, kMaxMotors> dac_codes{};
};

/// Scales and signs that turn counts and codes into units and back; constant during a session.
struct DeviceDescription {
  std::size_t motor_count = 3;
  std::size_t analog_input_count = 4;                          ///< force x, y, z (device frame), grip force
  std::array<double, kMaxMotors> encoder_rad_per_count{};      ///< motor shaft, sign included
  std::array<double, kMaxMotors> encoder_zero_rad{};           ///< joint angle at count 0
  std::array<double, kMaxMotors> transmission_ratio{};         ///< motor turns per joint turn
  std::array<double, kMaxMotors> torque_Nm_per_A{};            ///< motor torque constant, sign included
  double amplifier_A_per_V = 0.0;
  double current_limit_A = 0.0;
  int dac_bits = 12;
  double dac_range_V = 10.0;
  int adc_bits = 16;
  double adc_range_V = 10.0;
  std::array<double, kMaxAnalogInputs> analog_N_per_V{};
  double sample_time_s = 0.001;
};

/// One session with a device: open by construction, closed by stop() or destruction, which zero the DAC.
/// read() and write() are called in turn, once a sample; both are real-time safe and do not throw.
class Device {
 public:
  virtual ~Device() = default;
  virtual std::string_view name() const = 0;
  virtual const DeviceDescription& description() const = 0;
  /// Waits for nothing but the device itself. A reading that could not be taken has valid = false.
  virtual Reading read() noexcept = 0;
  /// False where the command did not reach the device.
  virtual bool write(const Command& command) noexcept = 0;
  /// Zero current, now; may be called at any time and more than once.
  virtual void stop() noexcept = 0;
  /// True where time is the simulation's own and need not be waited for.
  virtual bool lock_step() const = 0;
};

}  // namespace handloop::device
