#include "device/fault_injection.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "models/errors.h"
#include "models/suggest.h"

namespace handloop::device {
namespace {

/// What a spoiler may look at: the reading or command that passes, what went before, and how long the fault has lasted.
struct Passing {
  std::uint64_t since = 0;  ///< samples since the fault began
  const DeviceDescription& description;
  const Reading& at_onset;
  const Reading& last;
  const Command& last_command;
};

using SpoilReading = void (*)(Reading&, const Passing&);
/// False: the command does not reach the device.
using SpoilCommand = bool (*)(Command&, const Passing&);

struct Entry {
  InjectedFault info;
  SpoilReading on_read = nullptr;
  SpoilCommand on_write = nullptr;
};

[[noreturn]] void throw_std() {
  throw std::runtime_error("injected");
}
[[noreturn]] void throw_other() {
  throw 42;
}

std::uint32_t top_code(int bits) {
  return static_cast<std::uint32_t>(std::ldexp(1.0, bits) - 1.0);
}

template <std::size_t I>
void stuck(Reading& r, const Passing& p) {
  r.encoder_counts[I] = p.at_onset.encoder_counts[I];
}
template <std::size_t I>
void inverted(Reading& r, const Passing& p) {
  r.encoder_counts[I] = 2 * p.at_onset.encoder_counts[I] - r.encoder_counts[I];
}
template <std::size_t I, int Counts>
void jumped(Reading& r, const Passing&) {
  r.encoder_counts[I] += Counts;
}
template <int Bits>
void folded(Reading& r, const Passing&) {
  // A counter of fewer bits than the driver says, read without a sign.
  constexpr std::int32_t kFold = 1 << Bits;
  for (auto& counts : r.encoder_counts) counts = ((counts % kFold) + kFold) % kFold;
}
template <std::size_t I>
void drifting(Reading& r, const Passing& p) {
  r.encoder_counts[I] += static_cast<std::int32_t>(p.since);
}
template <std::size_t I>
void losing_counts(Reading& r, const Passing& p) {
  const std::int32_t moved = r.encoder_counts[I] - p.at_onset.encoder_counts[I];
  r.encoder_counts[I] -= moved / 4;
}
void shaking(Reading& r, const Passing& p) {
  for (auto& counts : r.encoder_counts) counts += p.since % 2 == 0 ? 40 : -40;
}
template <std::size_t I>
void random_counts(Reading& r, const Passing& p) {
  std::uint64_t bits = (p.since + 1) * 0x9e3779b97f4a7c15ULL;
  bits ^= bits >> 29;
  r.encoder_counts[I] = static_cast<std::int32_t>(bits);
}
void swapped_encoders(Reading& r, const Passing&) {
  std::swap(r.encoder_counts[1], r.encoder_counts[2]);
}
void zero_counts(Reading& r, const Passing&) {
  r.encoder_counts.fill(0);
}
void all_bits(Reading& r, const Passing&) {
  r.encoder_counts.fill(-1);
  for (auto& code : r.adc_codes) code = 0xffffffff;
}
void coarse(Reading& r, const Passing&) {
  for (auto& counts : r.encoder_counts) counts = counts / 64 * 64;
}

template <std::size_t I>
void dead_sensor(Reading& r, const Passing& p) {
  r.adc_codes[I] = p.at_onset.adc_codes[I];
}
void sensor_high(Reading& r, const Passing& p) {
  r.adc_codes[0] = r.adc_codes[1] = r.adc_codes[2] = top_code(p.description.adc_bits);
}
void sensor_low(Reading& r, const Passing&) {
  r.adc_codes[2] = 0;
}
void swapped_sensors(Reading& r, const Passing&) {
  std::swap(r.adc_codes[0], r.adc_codes[2]);
}
void inverted_sensor(Reading& r, const Passing& p) {
  for (std::size_t i = 0; i < 3; ++i) r.adc_codes[i] = top_code(p.description.adc_bits) - r.adc_codes[i];
}
void sensor_out_of_range(Reading& r, const Passing& p) {
  r.adc_codes[1] = top_code(p.description.adc_bits) + 100;
}

void no_reading(Reading& r, const Passing&) {
  r.valid = false;
}
template <int Every>
void some_readings_missing(Reading& r, const Passing& p) {
  if (p.since % Every != 0) r.valid = false;
}
void dropout_of_10(Reading& r, const Passing& p) {
  if (p.since < 10) r.valid = false;
}
void frozen(Reading& r, const Passing& p) {
  r = p.at_onset;
}
void doubled(Reading& r, const Passing& p) {
  if (p.since % 2 == 1) r = p.last;
}
void reordered(Reading& r, const Passing& p) {
  if (p.since % 3 == 2) r.sample -= 2;
}
void sample_ahead(Reading& r, const Passing& p) {
  if (p.since >= 1) r.sample += 1000;
}
void sample_overflow(Reading& r, const Passing&) {
  r.sample = ~std::uint64_t{0};
}
void time_backwards(Reading& r, const Passing& p) {
  r.time_ns -= static_cast<std::int64_t>(p.since) * 2'000'000;
}
void late_200(Reading& r, const Passing&) {
  r.sample += 200;
}

bool lost_command(Command&, const Passing&) {
  return false;
}
bool every_other_lost(Command&, const Passing& p) {
  return p.since % 2 == 0;
}
bool swapped_motors(Command& c, const Passing&) {
  std::swap(c.dac_codes[1], c.dac_codes[2]);
  return true;
}
bool inverted_motor(Command& c, const Passing& p) {
  c.dac_codes[2] = top_code(p.description.dac_bits) - c.dac_codes[2];
  return true;
}
bool held_command(Command& c, const Passing& p) {
  c = p.last_command;
  return true;
}
bool missing_low_bits(Command& c, const Passing&) {
  for (auto& code : c.dac_codes) code &= ~std::uint32_t{0x1f};
  return true;
}
bool dead_motor(Command& c, const Passing& p) {
  c.dac_codes[2] = top_code(p.description.dac_bits) / 2 + 1;
  return true;
}
void throw_std_on_read(Reading&, const Passing&) {
  throw_std();
}
void throw_other_on_read(Reading&, const Passing&) {
  throw_other();
}
void throw_once_on_read(Reading&, const Passing& p) {
  if (p.since == 0) throw_std();
}
bool throw_std_on_write(Command&, const Passing&) {
  throw_std();
}
bool throw_other_on_write(Command&, const Passing&) {
  throw_other();
}
bool throw_once_on_write(Command&, const Passing& p) {
  if (p.since == 0) throw_std();
  return true;
}

constexpr auto kRead = Hook::read;
constexpr auto kWrite = Hook::write;

const std::vector<Entry>& entries() {
  static const std::vector<Entry> kEntries{
      {{"encoder_stuck_1", "counter 1 stays where it is", kRead}, stuck<0>},
      {{"encoder_stuck_2", "counter 2 stays where it is", kRead}, stuck<1>},
      {{"encoder_stuck_3", "counter 3 stays where it is", kRead}, stuck<2>},
      {{"encoder_inverted_1", "counter 1 counts backwards (channels A and B swapped)", kRead}, inverted<0>},
      {{"encoder_inverted_2", "counter 2 counts backwards", kRead}, inverted<1>},
      {{"encoder_inverted_3", "counter 3 counts backwards", kRead}, inverted<2>},
      {{"encoder_jump_small", "counter 3 jumps by 500 counts", kRead}, jumped<2, 500>},
      {{"encoder_jump_large", "counter 2 jumps by a million counts", kRead}, jumped<1, 1'000'000>},
      {{"encoder_overflow_8", "counters fold at 8 bits", kRead}, folded<8>},
      {{"encoder_overflow_16", "counters fold at 16 bits, without a sign", kRead}, folded<16>},
      {{"encoder_drift", "counter 3 gains a count a sample", kRead}, drifting<2>},
      {{"encoder_loses_counts", "counter 3 misses one edge in four", kRead}, losing_counts<2>},
      {{"encoder_shaking", "all counters shake by 40 counts", kRead}, shaking},
      {{"encoder_random", "counter 1 reads random numbers", kRead}, random_counts<0>},
      {{"encoders_swapped", "counters 2 and 3 are swapped", kRead}, swapped_encoders},
      {{"encoders_zero", "all counters read 0", kRead}, zero_counts},
      {{"encoders_coarse", "the counters' low six bits are missing", kRead}, coarse},
      {{"all_bits_set", "every register reads all ones (a board that is gone)", kRead}, all_bits},
      {{"sensor_dead_1", "force channel 1 stays at one code", kRead}, dead_sensor<0>},
      {{"sensor_dead_3", "force channel 3 stays at one code", kRead}, dead_sensor<2>},
      {{"sensor_high", "all force channels at the top of the range", kRead}, sensor_high},
      {{"sensor_low", "force channel 3 at the bottom of the range", kRead}, sensor_low},
      {{"sensor_out_of_range", "force channel 2 gives a code the converter does not have", kRead}, sensor_out_of_range},
      {{"sensors_swapped", "force channels 1 and 3 are swapped", kRead}, swapped_sensors},
      {{"sensor_inverted", "the force channels have the wrong sign", kRead}, inverted_sensor},
      {{"no_reading", "no sample is fresh any more", kRead}, no_reading},
      {{"every_second_reading_missing", "every second sample is missing", kRead}, some_readings_missing<2>},
      {{"nine_of_ten_readings_missing", "nine samples of ten are missing", kRead}, some_readings_missing<10>},
      {{"dropout_of_10", "ten samples are missing, once", kRead}, dropout_of_10},
      {{"reading_frozen", "the same sample for ever", kRead}, frozen},
      {{"readings_doubled", "every sample comes twice", kRead}, doubled},
      {{"readings_reordered", "every third sample is older than the last", kRead}, reordered},
      {{"sample_number_ahead", "sample numbers leap by 1000", kRead}, sample_ahead},
      {{"sample_number_overflow", "the sample number is the largest there is", kRead}, sample_overflow},
      {{"readings_200_late", "200 samples were slept through", kRead}, late_200},
      {{"time_backwards", "the device's time runs backwards", kRead}, time_backwards},
      {{"write_fails", "no command reaches the device", kWrite}, nullptr, lost_command},
      {{"every_second_write_fails", "every second command is lost", kWrite}, nullptr, every_other_lost},
      {{"motors_swapped", "motors 2 and 3 are swapped", kWrite}, nullptr, swapped_motors},
      {{"motor_inverted", "motor 3 turns the wrong way", kWrite}, nullptr, inverted_motor},
      {{"motor_dead", "motor 3 gets no current", kWrite}, nullptr, dead_motor},
      {{"dac_held", "the DACs keep the last codes", kWrite}, nullptr, held_command},
      {{"dac_missing_bits", "the DACs' low five bits are missing", kWrite}, nullptr, missing_low_bits},
      {{"throw_on_start", "start() throws a std::exception", Hook::start}},
      {{"throw_unknown_on_start", "start() throws something else", Hook::start}},
      {{"throw_on_read", "read() throws a std::exception", kRead}, throw_std_on_read},
      {{"throw_unknown_on_read", "read() throws something else", kRead}, throw_other_on_read},
      {{"throw_once_on_read", "read() throws once", kRead}, throw_once_on_read},
      {{"throw_on_write", "write() throws a std::exception", kWrite}, nullptr, throw_std_on_write},
      {{"throw_unknown_on_write", "write() throws something else", kWrite}, nullptr, throw_other_on_write},
      {{"throw_once_on_write", "write() throws once", kWrite}, nullptr, throw_once_on_write},
      {{"throw_on_stop", "stop() throws a std::exception", Hook::stop}},
      {{"throw_unknown_on_stop", "stop() throws something else", Hook::stop}},
  };
  return kEntries;
}

const Entry& find(std::string_view name) {
  std::vector<std::string_view> names;
  for (const auto& entry : entries()) {
    if (entry.info.name == name) return entry;
    names.push_back(entry.info.name);
  }
  throw InputError("no fault is called '" + std::string(name) + "'" + suggestion(name, names));
}

}  // namespace

std::span<const InjectedFault> injectable_faults() {
  static const std::vector<InjectedFault> kInfos = [] {
    std::vector<InjectedFault> infos;
    for (const auto& entry : entries()) infos.push_back(entry.info);
    return infos;
  }();
  return kInfos;
}

struct FaultyDevice::Spoiler {
  const Entry& entry;
  Reading at_onset, last;
  Command last_command;
  bool begun = false;

  Passing passing(std::uint64_t since, const DeviceDescription& description) const {
    return {since, description, at_onset, last, last_command};
  }
  /// Exceptions of the hooks that carry no data.
  void strike(Hook hook) const {
    if (entry.info.hook != hook) return;
    if (entry.info.name.find("unknown") != std::string_view::npos) throw_other();
    throw_std();
  }
};

FaultyDevice::FaultyDevice(Device& inner, std::string_view fault, std::uint64_t from_sample)
    : inner_(inner), from_sample_(from_sample), spoiler_(new Spoiler{find(fault), {}, {}, {}}) {}

FaultyDevice::~FaultyDevice() = default;

void FaultyDevice::start() {
  reads_ = 0;
  spoiler_->begun = false;
  if (spoiler_->entry.info.hook == Hook::start) spoiler_->strike(Hook::start);
  inner_.start();
}

Reading FaultyDevice::read() {
  Reading reading = inner_.read();
  const std::uint64_t number = reads_++;
  if (number < from_sample_) {
    spoiler_->last = reading;
    return reading;
  }
  if (!spoiler_->begun) spoiler_->at_onset = reading;
  spoiler_->begun = true;
  const Reading truth = reading;
  if (spoiler_->entry.on_read != nullptr) {
    spoiler_->entry.on_read(reading, spoiler_->passing(number - from_sample_, inner_.description()));
  }
  spoiler_->last = truth;
  return reading;
}

bool FaultyDevice::write(const Command& command) {
  Command spoilt = command;
  if (spoiler_->begun && spoiler_->entry.on_write != nullptr) {
    const auto since = reads_ - 1 - from_sample_;
    if (!spoiler_->entry.on_write(spoilt, spoiler_->passing(since, inner_.description()))) {
      // The plant lives on with what it last got.
      inner_.write(spoiler_->last_command);
      return false;
    }
  }
  spoiler_->last_command = spoilt;
  return inner_.write(spoilt);
}

void FaultyDevice::stop() {
  inner_.stop();
  spoiler_->strike(Hook::stop);
}

Injection parse_injection(std::string_view text) {
  Injection injection;
  const auto at = text.find('@');
  injection.name = text.substr(0, at);
  find(injection.name);
  if (at == std::string_view::npos) return injection;
  const std::string_view number = text.substr(at + 1);
  const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), injection.from_sample);
  if (error != std::errc{} || end != number.data() + number.size()) {
    throw InputError("--inject '" + std::string(text) + "': after @ comes the number of a sample, as in " +
                     injection.name + "@1000");
  }
  return injection;
}

}  // namespace handloop::device
