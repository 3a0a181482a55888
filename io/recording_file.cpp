#include "io/recording_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <functional>
#include <optional>
#include <span>

#include "io/csv_file.h"
#include "io/mat_file.h"
#include "io/output.h"
#include "models/errors.h"
#include "models/suggest.h"

namespace handloop::io {
namespace {

using models::Recording;

/// One column or vector, wherever it came from.
struct Channel {
  std::string name;
  std::vector<double> values;
};

/// What a file gave, before it is checked.
struct Channels {
  Channel time;  ///< empty where a rate was given and the file has no times
  Channel force, position, grip_force;
  /// "FILE, line 12" or "FILE, element 12" of a row from 0.
  std::function<std::string(std::size_t row)> place;
};

// Usual names, the contract's first.
constexpr std::array<std::string_view, 3> kTimeNames{"time_s", "time_ms", "time_us"};
constexpr std::array<std::string_view, 5> kForceNames{"force_N", "torque_Nm", "force_Nm", "force", "torque"};
constexpr std::array<std::string_view, 5> kPositionNames{"position_m", "angle_rad", "position_rad", "position",
                                                         "angle"};
constexpr std::array<std::string_view, 1> kGripNames{"grip_force_N"};

std::string unit_of(std::string_view column) {
  for (const std::string_view unit : {"N", "Nm", "m", "rad"}) {
    if (column.size() > unit.size() + 1 && column.ends_with(unit) && column[column.size() - unit.size() - 1] == '_') {
      return std::string(unit);
    }
  }
  return "as_recorded";
}

double seconds_per_unit(std::string_view time_column) {
  if (time_column.ends_with("_ms")) return 1e-3;
  if (time_column.ends_with("_us")) return 1e-6;
  return 1.0;
}

// ---- CSV
// -------------------------------------------------------------------------------------------------------------

/// The column asked for, or the first usual name present. `flag` is what a person would type to choose another.
std::optional<std::size_t> choose(const CsvFile& file, const std::string& asked,
                                  std::span<const std::string_view> usual, const char* flag, bool required) {
  if (!asked.empty()) return file.require(asked);
  for (const auto name : usual) {
    if (const auto found = file.find(name)) return found;
  }
  if (!required) return std::nullopt;
  if (!file.has_header()) {
    throw InputError(fmt::format("{}: has no header line; choose among columns 1 to {} with {}", file.name(),
                                 file.columns().size(), flag));
  }
  try {
    file.require(usual.front());
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}; choose one with {}", error.what(), flag));
  }
  return std::nullopt;
}

Channels from_csv(const CsvFile& file, const RecordingOptions& options) {
  std::vector<std::size_t> wanted;
  std::vector<Channel Channels::*> targets;
  const auto want = [&](std::optional<std::size_t> column, Channel Channels::*target) {
    if (!column) return;
    wanted.push_back(*column);
    targets.push_back(target);
  };
  const bool needs_time = !(options.rate_Hz > 0);
  want(choose(file, options.time, kTimeNames, "--time (or give --rate HZ)", needs_time), &Channels::time);
  want(choose(file, options.force, kForceNames, "--force", true), &Channels::force);
  want(choose(file, options.position, kPositionNames, "--position", true), &Channels::position);
  want(choose(file, options.grip_force, kGripNames, "", false), &Channels::grip_force);
  auto values = file.read_numbers(wanted);
  Channels channels;
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    channels.*targets[i] = {file.has_header() ? file.columns()[wanted[i]] : "column " + file.columns()[wanted[i]],
                            std::move(values[i])};
  }
  channels.place = [name = file.name(), first = file.line_of_row(0)](std::size_t row) {
    return fmt::format("{}, line {}", name, first + row);
  };
  return channels;
}

// ---- MATLAB
// ----------------------------------------------------------------------------------------------------------

Channels from_mat(const std::filesystem::path& path, const RecordingOptions& options) {
  auto vectors = read_mat_vectors(path);
  std::vector<std::string_view> names;
  for (const auto& vector : vectors) names.push_back(vector.name);
  std::string list;
  for (const auto name : names) list += fmt::format("{}{}", list.empty() ? "" : ", ", name);
  const auto pick = [&](const std::string& asked, std::span<const std::string_view> usual, const char* flag,
                        bool required) -> Channel {
    for (auto& vector : vectors) {
      if (!asked.empty() ? vector.name == asked : std::find(usual.begin(), usual.end(), vector.name) != usual.end()) {
        return {vector.name, vector.values};
      }
    }
    if (asked.empty() && !required) return {};
    const auto near = asked.empty() ? std::string_view() : nearest_word(asked, names);
    throw InputError(fmt::format("{}: no vector '{}'; {}vectors are {}{}", path.string(),
                                 asked.empty() ? usual.front() : asked,
                                 near.empty() ? "" : fmt::format("did you mean '{}'? ", near), list,
                                 asked.empty() ? fmt::format("; choose one with {}", flag) : ""));
  };
  Channels channels;
  channels.time = pick(options.time, kTimeNames, "--time (or give --rate HZ)", !(options.rate_Hz > 0));
  channels.force = pick(options.force, kForceNames, "--force", true);
  channels.position = pick(options.position, kPositionNames, "--position", true);
  channels.grip_force = pick(options.grip_force, kGripNames, "", false);
  const auto file = path.string();
  channels.place = [file](std::size_t row) { return fmt::format("{}, element {}", file, row + 1); };
  for (const auto* channel : {&channels.time, &channels.force, &channels.position, &channels.grip_force}) {
    if (channel->name.empty()) continue;
    if (channel->values.size() != channels.force.values.size()) {
      throw InputError(fmt::format("{}: vector {} has {} values where {} has {}", file, channel->name,
                                   channel->values.size(), channels.force.name, channels.force.values.size()));
    }
    for (std::size_t i = 0; i < channel->values.size(); ++i) {
      if (!std::isfinite(channel->values[i])) {
        throw InputError(fmt::format("{}, vector {}: {} is not a finite number", channels.place(i), channel->name,
                                     channel->values[i]));
      }
    }
  }
  return channels;
}

// ---- checks
// ----------------------------------------------------------------------------------------------------------

/// Sample time of a uniform time channel. Clocks jitter a little; a missing row, a step backwards or another rate does
/// not pass, for every method downstream counts samples.
double uniform_sample_time_s(const Channels& channels) {
  const auto& time = channels.time.values;
  const double unit = seconds_per_unit(channels.time.name);
  const auto count = time.size();
  std::vector<double> steps(std::min<std::size_t>(count - 1, 1001));
  for (std::size_t i = 0; i < steps.size(); ++i) steps[i] = time[i + 1] - time[i];
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  const double usual = *middle;
  for (std::size_t i = 1; i < count; ++i) {
    const double step = time[i] - time[i - 1];
    if (!(step > 0)) {
      throw InputError(
          fmt::format("{}: {} does not increase ({:g} after {:g}); if it was written with too few digits give "
                      "--rate HZ instead",
                      channels.place(i), channels.time.name, time[i], time[i - 1]));
    }
    if (step > 1.5 * usual) {
      throw InputError(
          fmt::format("{}: gap of {:.6g} s in {} where samples are {:.6g} s apart; cut the recording there",
                      channels.place(i), step * unit, channels.time.name, usual * unit));
    }
  }
  const double mean = (time.back() - time.front()) / static_cast<double>(count - 1);
  for (std::size_t i = 1; i < count; ++i) {
    const double off_grid = time[i] - (time.front() + static_cast<double>(i) * mean);
    if (std::abs(off_grid) > 0.5 * mean) {
      throw InputError(fmt::format("{}: {} is not uniform ({:.3g} s off a steady {:.6g} Hz); resample it to one rate",
                                   channels.place(i), channels.time.name, off_grid * unit, 1 / (mean * unit)));
    }
  }
  // Times are written in decimals: the rate they mean is the round one they are within rounding of.
  const double rate = 1 / (mean * unit);
  const double round_rate = std::round(rate * 1000) / 1000;
  return 1 / (std::abs(rate - round_rate) < 1e-6 * rate && round_rate > 0 ? round_rate : rate);
}

/// A rate that was given must be that of the times, where there are any: one of the two is a mistake, and mass goes
/// with its square. Times may be written with few digits.
void require_agreement(const Channels& channels, double rate_Hz) {
  constexpr double kAgreement = 0.02;
  const auto& time = channels.time.values;
  if (time.size() < 2) return;
  const double span_s = (time.back() - time.front()) * seconds_per_unit(channels.time.name);
  const double recorded_Hz = static_cast<double>(time.size() - 1) / span_s;
  if (std::isfinite(recorded_Hz) && std::abs(recorded_Hz / rate_Hz - 1) < kAgreement) return;
  throw InputError(
      fmt::format("{}: {} runs over {:.6g} s in {} rows ({:.6g} Hz), not at --rate {:g}; leave out --rate, "
                  "or the column where its times are wrong",
                  channels.place(0), channels.time.name, span_s, time.size(), recorded_Hz, rate_Hz));
}

void require_varying(const Channels& channels, const Channel& channel) {
  const auto& values = channel.values;
  if (std::adjacent_find(values.begin(), values.end(), std::not_equal_to<>()) != values.end()) return;
  throw InputError(fmt::format("{}: {} is constant ({:g} in all {} rows); a recording needs motion and force that vary",
                               channels.place(0), channel.name, values.front(), values.size()));
}

Recording check(Channels channels, const std::string& name, const RecordingOptions& options) {
  const auto rows = channels.force.values.size();
  if (rows == 0) throw InputError(name + ": has a header but no rows");
  if (rows < std::max<std::size_t>(options.minimum_rows, 2)) {
    throw InputError(fmt::format("{}: has {} row{}; at least {} are needed", name, rows, rows == 1 ? "" : "s",
                                 std::max<std::size_t>(options.minimum_rows, 2)));
  }
  Recording recording;
  recording.name = name;
  if (options.rate_Hz > 0) {
    require_agreement(channels, options.rate_Hz);
    recording.sample_time_s = 1 / options.rate_Hz;
  } else {
    recording.sample_time_s = uniform_sample_time_s(channels);
    recording.start_time_s = channels.time.values.front() * seconds_per_unit(channels.time.name);
  }
  require_varying(channels, channels.force);
  require_varying(channels, channels.position);
  recording.force_unit = unit_of(channels.force.name);
  recording.position_unit = unit_of(channels.position.name);
  // A torque beside a position in metres (a drive and its slide) is neither: both keep the unit they are marked with.
  recording.rotary = (recording.force_unit == "Nm" || recording.position_unit == "rad") &&
                     recording.force_unit != "N" && recording.position_unit != "m";
  // A unit that cannot be one of this channel says nothing: a drive's "u_m" is no metre of force.
  if (recording.force_unit == "m" || recording.force_unit == "rad") recording.force_unit = "as_recorded";
  if (recording.position_unit == "N" || recording.position_unit == "Nm") recording.position_unit = "as_recorded";
  recording.force_N = std::move(channels.force.values);
  recording.position_m = std::move(channels.position.values);
  recording.grip_force_N = std::move(channels.grip_force.values);
  return recording;
}

void check_options(const RecordingOptions& options) {
  if (!std::isfinite(options.rate_Hz) || options.rate_Hz < 0) {
    throw InputError(fmt::format("--rate {:g}: give samples a second, above 0", options.rate_Hz));
  }
}

/// Shortest text that reads back to the same bits.
void append_number(std::string& text, double value) {
  std::array<char, 32> digits;
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
  text.append(digits.data(), end);
}

void append_time(std::string& text, double value) {
  std::array<char, 32> digits;
  const auto end =
      std::to_chars(digits.data(), digits.data() + digits.size(), value, std::chars_format::general, 12).ptr;
  text.append(digits.data(), end);
}

}  // namespace

Recording read_recording(const std::filesystem::path& path, const RecordingOptions& options) {
  check_options(options);
  if (path.extension() == ".mat") return check(from_mat(path, options), path.string(), options);
  const CsvFile file(path);
  return check(from_csv(file, options), path.string(), options);
}

Recording parse_recording(std::string_view csv_text, const std::string& name, const RecordingOptions& options) {
  check_options(options);
  const CsvFile file(csv_text, name);
  return check(from_csv(file, options), name, options);
}

void write_recording(const std::filesystem::path& path, const Recording& recording) {
  const auto column = [](const char* quantity, const std::string& unit) {
    return unit == "as_recorded" ? std::string(quantity) : fmt::format("{}_{}", quantity, unit);
  };
  const bool grip = !recording.grip_force_N.empty();
  OutputFile file(path);
  file.write(fmt::format("time_s,{},{}{}\n",
                         column(recording.force_unit == "Nm" ? "torque" : "force", recording.force_unit),
                         column(recording.position_unit == "rad" ? "angle" : "position", recording.position_unit),
                         grip ? ",grip_force_N" : ""));
  std::string row;
  for (std::size_t i = 0; i < recording.size(); ++i) {
    row.clear();
    append_time(row, recording.start_time_s + static_cast<double>(i) * recording.sample_time_s);
    row += ',';
    append_number(row, recording.force_N[i]);
    row += ',';
    append_number(row, recording.position_m[i]);
    if (grip) {
      row += ',';
      append_number(row, recording.grip_force_N[i]);
    }
    row += '\n';
    file.write(row);
  }
  file.commit();
}

}  // namespace handloop::io
