#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

/// A haptic device in hardware terms. The loop sees nothing else, so it cannot tell a simulation from the real thing.
namespace handloop::device {

inline constexpr std::size_t kMaxMotors = 3;
inline constexpr std::size_t kMaxAnalogInputs = 8;

/// What one sample reads. Counters and codes are raw, as the boards deliver them; scales live in DeviceDescription.
struct Reading {
  std::uint64_t sample = 0;                                 ///< counts from 0 in each session
  std::int64_t time_ns = 0;                                 ///< since the session's start; virtual in lock-step
  std::array<std::int32_t, kMaxMotors> encoder_counts{};    ///< wraps; differences are exact
  std::array<std::uint32_t, kMaxAnalogInputs> adc_codes{};  ///< offset binary, 0 .. 2^bits - 1
  bool valid = false;                                       ///< false: no fresh sample (late, lost, dead)

  bool operator==(const Reading&) const = default;
};

/// What one sample writes: DAC codes, offset binary. No code is exactly 0 V: zero_code() is the nearest above.
struct Command {
  std::uint64_t sample = 0;
  std::array<std::uint32_t, kMaxMotors> dac_codes{};

  bool operator==(const Command&) const = default;
};

/// Scales and signs that turn counts and codes into units and back; constant during a session.
struct DeviceDescription {
  std::size_t motor_count = 3;
  std::size_t analog_input_count = 4;                      ///< force x, y, z (device frame), grip force
  std::array<double, kMaxMotors> encoder_rad_per_count{};  ///< motor shaft, sign included
  std::array<double, kMaxMotors> encoder_zero_rad{};       ///< joint angle at count 0
  std::array<double, kMaxMotors> transmission_ratio{};     ///< motor turns per joint turn
  std::array<double, kMaxMotors> torque_Nm_per_A{};        ///< motor torque constant, sign included
  double amplifier_A_per_V = 0.0;
  double current_limit_A = 0.0;
  int dac_bits = 12;
  double dac_range_V = 10.0;
  int adc_bits = 16;
  double adc_range_V = 10.0;
  std::array<double, kMaxAnalogInputs> analog_N_per_V{};
  /// Strain gauges in the place of one channel an axis: force along x, y, z = rows of this matrix times the volts of
  /// the first `gauge_count` inputs (a sensor maker's calibration). 0: inputs 0, 1, 2 are the axes themselves.
  std::size_t gauge_count = 0;
  std::array<std::array<double, kMaxAnalogInputs>, 3> gauge_N_per_V{};
  /// The same for a sensor at the device's environment; zero where there is none.
  std::array<std::array<double, kMaxAnalogInputs>, 3> environment_N_per_V{};
  double sample_time_s = 0.001;
  bool recorded = false;  ///< a recording does not answer to commands: what follows from them cannot be checked
  bool ideal = false;     ///< noise-free: a constant sensor is then no sign of a dead one
};

/// One session with a device, one thread. start() once, then read() and write() in turn, once a sample; stop() at any
/// time.
///
/// A session has no delay of its own: what write() is given acts from that moment until the next write (zero-order
/// hold), and read() tells the present. Delay belongs to the loop (see Loop), so that it is the same on every device.
/// read(), write() and stop() are real-time safe. They should not throw; the loop survives it where one does.
class Device {
 public:
  virtual ~Device() = default;
  virtual std::string_view name() const = 0;
  virtual const DeviceDescription& description() const = 0;
  /// Makes the session ready: sample 0 is the next one read, all DACs are at zero. Not real-time safe.
  /// Throws InputError (no such device) or RequirementError (device refuses).
  virtual void start() = 0;
  /// Waits for nothing but the device itself. A reading that could not be taken has valid = false.
  virtual Reading read() = 0;
  /// False where the command did not reach the device.
  virtual bool write(const Command& command) = 0;
  /// Zero current, now; may be called at any time and more than once.
  virtual void stop() = 0;
  /// True where time is the device's own and need not be waited for: simulation and replay.
  virtual bool lock_step() const = 0;
};

}  // namespace handloop::device
