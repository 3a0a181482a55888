#include "device/comedi/boards.h"

#include <fmt/format.h>

#include "models/errors.h"

namespace handloop::device::comedi {
namespace {

// The middle of 32 bits: neither direction folds soon, and what folds is unwrapped.
constexpr lsampl_t kMiddle = 0x80000000u;
constexpr unsigned kNoGate = NI_GPCT_DISABLED_GATE_SELECT;

std::string reason() {
  return comedi_strerror(comedi_errno());
}

void require_type(comedi_t* board, const std::string& path, int subdevice, int type, std::string_view what) {
  const int count = comedi_get_n_subdevices(board);
  if (subdevice < 0 || subdevice >= count) {
    throw InputError(fmt::format("{}: has {} subdevices, no number {} ({})", path, count, subdevice, what));
  }
  if (comedi_get_subdevice_type(board, static_cast<unsigned>(subdevice)) != type) {
    throw InputError(
        fmt::format("{}: subdevice {} is not {} ({})", path, subdevice, what, comedi_get_board_name(board)));
  }
}

/// Index of the bipolar range of so many volts.
unsigned bipolar_range(comedi_t* board, const std::string& path, int subdevice, int channel, double range_V) {
  const auto sub = static_cast<unsigned>(subdevice), chan = static_cast<unsigned>(channel);
  const int channels = comedi_get_n_channels(board, sub);
  if (channel >= channels) {
    throw InputError(fmt::format("{}: subdevice {} has {} channels, no number {}", path, subdevice, channels, channel));
  }
  std::string known;
  for (int i = 0; i < comedi_get_n_ranges(board, sub, chan); ++i) {
    const comedi_range* range = comedi_get_range(board, sub, chan, static_cast<unsigned>(i));
    if (range == nullptr) continue;
    if (range->unit == UNIT_volt && range->max == range_V && range->min == -range_V) return static_cast<unsigned>(i);
    known += fmt::format("{}{:g} to {:g}", known.empty() ? "" : ", ", range->min, range->max);
  }
  throw InputError(
      fmt::format("{}: subdevice {} has no range of +-{} V; it has {} V", path, subdevice, range_V, known));
}

comedi_insn instruction(unsigned what, unsigned subdevice, unsigned channel_spec, lsampl_t* value) {
  comedi_insn insn{};
  insn.insn = what;
  insn.n = 1;
  insn.data = value;
  insn.subdev = subdevice;
  insn.chanspec = channel_spec;
  return insn;
}

}  // namespace

Board open_board(const std::string& path) {
  comedi_loglevel(0);  // errors are ours to tell
  Board board(comedi_open(path.c_str()));
  if (!board) throw InputError(fmt::format("{}: no Comedi board: {}", path, reason()));
  return board;
}

// ---- counters -------------------------------------------------------------------------------------------------------

EncoderCounters::EncoderCounters(const ComediConfig::Encoders& config)
    : config_(config), board_(open_board(config.board)) {
  for (const int subdevice : config_.subdevices) {
    require_type(board_.get(), config_.board, subdevice, COMEDI_SUBD_COUNTER, "a counter");
  }
}

void EncoderCounters::start() {
  tolerated_.clear();
  for (const int subdevice : config_.subdevices) start_counter(static_cast<unsigned>(subdevice));
}

void EncoderCounters::start_counter(unsigned subdevice) {
  comedi_t* board = board_.get();
  const auto must = [&](int result, std::string_view call) {
    if (result < 0) {
      throw InputError(fmt::format("{}: counter {}: {}: {}", config_.board, subdevice, call, reason()));
    }
  };
  const auto may = [&](int result, std::string_view call) {
    if (result < 0) tolerated_.push_back(fmt::format("{}: counter {}: {} refused", config_.board, subdevice, call));
  };
  // The order of comedilib's demo gpct_encoder.c.
  must(comedi_reset(board, subdevice), "comedi_reset");
  for (unsigned channel = 0; channel < 3; ++channel) {  // the counter and its two load registers
    must(comedi_data_write(board, subdevice, channel, 0, 0, kMiddle), "comedi_data_write");
  }
  must(comedi_set_gate_source(board, subdevice, 0, 0, kNoGate), "comedi_set_gate_source 0");
  must(comedi_set_gate_source(board, subdevice, 0, 1, kNoGate), "comedi_set_gate_source 1");
  // A, B and Z: on the 660x they are wired to SOURCE, AUX and GATE, and the call fails by design.
  may(comedi_set_other_source(board, subdevice, 0, NI_GPCT_SOURCE_ENCODER_A, NI_GPCT_PFI_OTHER_SELECT(39)),
      "encoder A");
  may(comedi_set_other_source(board, subdevice, 0, NI_GPCT_SOURCE_ENCODER_B, NI_GPCT_PFI_OTHER_SELECT(37)),
      "encoder B");
  if (config_.index_pulse) {
    may(comedi_set_other_source(board, subdevice, 0, NI_GPCT_SOURCE_ENCODER_Z, NI_GPCT_PFI_OTHER_SELECT(38)),
        "encoder Z");
  }
  unsigned mode = NI_GPCT_COUNTING_MODE_QUADRATURE_X4_BITS | NI_GPCT_COUNTING_DIRECTION_HW_UP_DOWN_BITS;
  if (config_.index_pulse) mode |= NI_GPCT_INDEX_ENABLE_BIT | NI_GPCT_INDEX_PHASE_HIGH_A_HIGH_B_BITS;
  must(comedi_set_counter_mode(board, subdevice, 0, mode), "comedi_set_counter_mode");
  must(comedi_arm(board, subdevice, NI_GPCT_ARM_IMMEDIATE), "comedi_arm");
}

bool EncoderCounters::read(std::array<std::int32_t, kMaxMotors>& counts) noexcept {
  for (std::size_t i = 0; i < kMaxMotors; ++i) {
    lsampl_t value = 0;
    if (comedi_data_read(board_.get(), static_cast<unsigned>(config_.subdevices[i]), 0, 0, 0, &value) < 0) return false;
    counts[i] = static_cast<std::int32_t>(value - kMiddle);
  }
  return true;
}

// ---- DACs -----------------------------------------------------------------------------------------------------------

MotorOutputs::MotorOutputs(const ComediConfig::Motors& config) : config_(config), board_(open_board(config.board)) {
  comedi_t* board = board_.get();
  require_type(board, config_.board, config_.subdevice, COMEDI_SUBD_AO, "an analog output");
  const auto subdevice = static_cast<unsigned>(config_.subdevice);
  for (std::size_t i = 0; i < kMaxMotors; ++i) {
    range_ = bipolar_range(board, config_.board, config_.subdevice, config_.channels[i], config_.range_V);
    maxdata_ = comedi_get_maxdata(board, subdevice, static_cast<unsigned>(config_.channels[i]));
    if (maxdata_ < 255) throw InputError(fmt::format("{}: the analog output has no resolution", config_.board));
    instructions_[i] = instruction(
        INSN_WRITE, subdevice, CR_PACK(static_cast<unsigned>(config_.channels[i]), range_, AREF_GROUND), &values_[i]);
  }
}

bool MotorOutputs::write(const std::array<std::uint32_t, kMaxMotors>& codes) noexcept {
  for (std::size_t i = 0; i < kMaxMotors; ++i) values_[i] = codes[i] <= maxdata_ ? codes[i] : zero();
  comedi_insnlist list{kMaxMotors, instructions_.data()};
  return comedi_do_insnlist(board_.get(), &list) == static_cast<int>(kMaxMotors);
}

bool MotorOutputs::write_zero() noexcept {
  constexpr int kTries = 3;
  bool all = true;
  for (const int channel : config_.channels) {
    bool taken = false;
    for (int attempt = 0; attempt < kTries && !taken; ++attempt) {
      taken = comedi_data_write(board_.get(), static_cast<unsigned>(config_.subdevice), static_cast<unsigned>(channel),
                                range_, AREF_GROUND, zero()) >= 0;
    }
    all = all && taken;
  }
  return all;
}

// ---- ADC ------------------------------------------------------------------------------------------------------------

ForceInputs::ForceInputs(const ComediConfig::Force& config) : config_(config) {
  if (!config_.present) return;
  board_ = open_board(config_.board);
  comedi_t* board = board_.get();
  require_type(board, config_.board, config_.subdevice, COMEDI_SUBD_AI, "an analog input");
  const auto subdevice = static_cast<unsigned>(config_.subdevice);
  for (std::size_t i = 0; i < config_.channels.size(); ++i) {
    const unsigned range = bipolar_range(board, config_.board, config_.subdevice, config_.channels[i], config_.range_V);
    maxdata_ = comedi_get_maxdata(board, subdevice, static_cast<unsigned>(config_.channels[i]));
    const unsigned reference = config_.differential ? AREF_DIFF : AREF_GROUND;
    instructions_[i] = instruction(INSN_READ, subdevice,
                                   CR_PACK(static_cast<unsigned>(config_.channels[i]), range, reference), &values_[i]);
  }
}

bool ForceInputs::read(std::array<std::uint32_t, kMaxAnalogInputs>& codes) noexcept {
  if (!config_.present) return true;
  const auto count = static_cast<unsigned>(config_.channels.size());
  comedi_insnlist list{count, instructions_.data()};
  if (comedi_do_insnlist(board_.get(), &list) != static_cast<int>(count)) return false;
  for (std::size_t i = 0; i < count; ++i) codes[i] = values_[i];
  return true;
}

}  // namespace handloop::device::comedi
