#pragma once

#include <comedilib.h>

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "device/comedi/comedi_config.h"

/// The three boards of a rig through libcomedi, each opened once. Constructors throw InputError naming board and
/// subdevice where it is missing or of another kind; what runs every sample returns false instead and is real-time safe
/// as far as the driver is (no allocation here).
namespace handloop::device::comedi {

struct CloseBoard {
  void operator()(comedi_t* board) const { comedi_close(board); }
};
using Board = std::unique_ptr<comedi_t, CloseBoard>;

/// Opens a board. Throws InputError with libcomedi's reason.
Board open_board(const std::string& path);

/// Quadrature counters of an NI 660x or any board with counter subdevices.
class EncoderCounters {
 public:
  explicit EncoderCounters(const ComediConfig::Encoders& config);
  /// Counters back to the middle of their range and counting. Throws InputError where a counter refuses.
  void start();
  bool read(std::array<std::int32_t, kMaxMotors>& counts) noexcept;
  /// What the driver refused without harm (the 660x has fixed inputs), for the log of the session.
  const std::vector<std::string>& tolerated() const { return tolerated_; }

 private:
  void start_counter(unsigned subdevice);
  ComediConfig::Encoders config_;
  Board board_;
  std::vector<std::string> tolerated_;
};

/// DACs of the motors.
class MotorOutputs {
 public:
  explicit MotorOutputs(const ComediConfig::Motors& config);
  unsigned maxdata() const { return maxdata_; }
  std::uint32_t zero() const { return maxdata_ / 2 + 1; }
  bool write(const std::array<std::uint32_t, kMaxMotors>& codes) noexcept;
  /// Zero volts on every channel, each tried by itself and more than once. True where all took it.
  bool write_zero() noexcept;

 private:
  ComediConfig::Motors config_;
  Board board_;
  unsigned maxdata_ = 0;
  unsigned range_ = 0;
  std::array<lsampl_t, kMaxMotors> values_{};
  std::array<comedi_insn, kMaxMotors> instructions_{};
};

/// ADC of the force sensor.
class ForceInputs {
 public:
  explicit ForceInputs(const ComediConfig::Force& config);
  unsigned maxdata() const { return maxdata_; }
  bool read(std::array<std::uint32_t, kMaxAnalogInputs>& codes) noexcept;

 private:
  ComediConfig::Force config_;
  Board board_;
  unsigned maxdata_ = 65535;
  std::array<lsampl_t, kMaxAnalogInputs> values_{};
  std::array<comedi_insn, kMaxAnalogInputs> instructions_{};
};

}  // namespace handloop::device::comedi
