#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "device/record.h"
#include "models/axis.h"

/// log.csv: one row a sample. Positions and forces are along the hand's axes (x left-right, y up-down, z
/// forward-backward), positions relative to the tip at the pose. Numbers are written with the fewest digits that give
/// the same double back, so equal runs give equal bytes. Nothing that a wall clock measured is in it.
namespace handloop::device {

/// How records become rows.
struct LogFormat {
  models::Axis axis = models::Axis::z;  ///< whose position and sensed force lead the row
  Eigen::Vector3d home_tip_m = Eigen::Vector3d::Zero();
  bool environment = false;  ///< with the force on the environment and the fifth analog input
};

/// Header line without line end. The first three columns make the log a recording (`handloop explain log.csv`).
std::string log_header(const LogFormat& format = {});
/// Writes one row with line end into `text` (at most `kMaxRow` bytes); returns its length. Does not allocate.
inline constexpr std::size_t kMaxRow = 1024;
std::size_t format_row(const StepRecord& record, const LogFormat& format, char* text);

/// A file that loses nothing: rows go to the kernel in whole lines every `flush_rows` rows, so a process that is killed
/// leaves a file that ends with a complete row, up to the last flush. A kill in the middle of a write can only cut it
/// between two pages of the file, so the last row of each page is made to end there: its time has more zeros. Errors
/// are kept, not thrown: a run must be able to end safely first. Not real-time safe.
class LogFile {
 public:
  /// Throws InputError where the file cannot be made.
  LogFile(const std::filesystem::path& path, const LogFormat& format, int flush_rows = 100);
  ~LogFile();
  LogFile(const LogFile&) = delete;
  LogFile& operator=(const LogFile&) = delete;

  /// False from the first write error on; what was written before stays.
  bool add(const StepRecord& record);
  bool flush();
  bool close();
  bool failed() const { return error_ != 0; }
  /// Of the first failure, for a person.
  std::string error() const;
  std::uint64_t rows() const { return rows_; }

 private:
  bool write_out();
  void append(std::string_view row);

  LogFormat format_;
  int flush_rows_;
  int descriptor_ = -1;
  int error_ = 0;
  int waiting_ = 0;
  std::uint64_t rows_ = 0;
  std::uint64_t position_ = 0;  ///< bytes of the file so far, those in the buffer included
  std::string buffer_;
};

}  // namespace handloop::device
