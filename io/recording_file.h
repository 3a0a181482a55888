#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "models/recording.h"

namespace handloop::io {

/// Which columns of a file hold what. Empty: the usual name, that is `time_s` (or `time_ms`, `time_us`), `force_N`
/// (or `torque_Nm`, `force`, `torque`), `position_m` (or `angle_rad`, `position`, `angle`), `grip_force_N` where
/// recorded. A column is given by name, or by its number from 1.
struct RecordingOptions {
  std::string time{};
  std::string force{};
  std::string position{};
  std::string grip_force{};
  double rate_Hz = 0.0;  ///< above zero: the time column, if any, is not read
  std::size_t minimum_rows = 100;
};

/// Reads a CSV file (or, by the ending .mat, a MATLAB file of named vectors) and checks what can be checked without a
/// model: rows complete and finite, time uniform and without gaps, enough rows, no channel constant.
///
/// Units come from the column's suffix: _N and _m, or _Nm and _rad (rotary); `as_recorded` otherwise. Nothing is
/// scaled, except that time columns in _ms or _us become seconds. Throws InputError of one line: file, line or vector,
/// what was wrong, what would be right.
models::Recording read_recording(const std::filesystem::path& path, const RecordingOptions& options = {});

/// The same from CSV text in memory; `name` stands for the file in messages.
models::Recording parse_recording(std::string_view csv_text, const std::string& name,
                                  const RecordingOptions& options = {});

/// Writes CSV that read_recording reads back to the same bits (time: to 12 digits), whole or not at all.
/// Throws InputError where the path cannot be written.
void write_recording(const std::filesystem::path& path, const models::Recording& recording);

}  // namespace handloop::io
