#include "device/log_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstring>

#include "models/errors.h"

namespace handloop::device {
namespace {

constexpr std::string_view kHeader =
    "time_s,force_N,position_m,sample,valid,x_m,y_m,z_m,velocity_x_m_per_s,velocity_y_m_per_s,velocity_z_m_per_s,"
    "sensed_x_N,sensed_y_N,sensed_z_N,grip_force_N,wanted_x_N,wanted_y_N,wanted_z_N,written_x_N,written_y_N,"
    "written_z_N,energy_J,contact,clipped,taken,fault,q1_rad,q2_rad,q3_rad,count_1,count_2,count_3,adc_1,adc_2,adc_3,"
    "adc_4,dac_1,dac_2,dac_3";

constexpr std::string_view kEnvironmentHeader = ",environment_x_N,environment_y_N,environment_z_N,adc_5";

// The kernel looks for fatal signals between two pages of one write.
constexpr std::size_t kPageBytes = 4096;
// No row is longer: 25 numbers of at most 24 characters, and 18 short ones.
constexpr std::size_t kLongestRow = 720;

class Row {
 public:
  explicit Row(char* text) : begin_(text), end_(text) {}

  template <typename T>
  void add(T value) {
    separate();
    end_ = std::to_chars(end_, begin_ + kMaxRow, value).ptr;
  }
  void add(bool value) {
    separate();
    *end_++ = value ? '1' : '0';
  }
  void add(std::string_view word) {
    separate();
    std::memcpy(end_, word.data(), word.size());
    end_ += word.size();
  }
  /// A vector of the device frame in the order of the hand's axes.
  void add_axes(const Eigen::Vector3d& v) {
    for (const auto axis : models::kAxes) add(v[models::device_row(axis)]);
  }
  void add_time(double seconds) {
    separate();
    end_ = std::to_chars(end_, begin_ + kMaxRow, seconds, std::chars_format::fixed).ptr;
  }
  std::size_t finish() {
    *end_++ = '\n';
    return static_cast<std::size_t>(end_ - begin_);
  }

 private:
  void separate() {
    if (end_ != begin_) *end_++ = ',';
  }
  char* begin_;
  char* end_;
};

}  // namespace

std::string log_header(const LogFormat& format) {
  std::string header(kHeader);
  if (format.environment) header += kEnvironmentHeader;
  return header;
}

std::size_t format_row(const StepRecord& r, const LogFormat& format, char* text) {
  const Eigen::Vector3d away = r.tip_m - format.home_tip_m;
  const int lead = models::device_row(format.axis);
  Row row(text);
  row.add_time(static_cast<double>(r.reading.time_ns) / 1e9);
  row.add(r.sensed_force_N[lead]);
  row.add(away[lead]);
  row.add(r.reading.sample);
  row.add(r.reading.valid);
  row.add_axes(away);
  row.add_axes(r.velocity_m_per_s);
  row.add_axes(r.sensed_force_N);
  row.add(r.grip_force_N);
  row.add_axes(r.wanted_force_N);
  row.add_axes(r.written_force_N);
  row.add(r.energy_J);
  row.add(r.in_contact);
  row.add(r.clipped);
  row.add(r.command_taken);
  row.add(fault_name(r.fault));
  for (int i = 0; i < 3; ++i) row.add(r.joint_rad[i]);
  for (const auto counts : r.reading.encoder_counts) row.add(counts);
  for (std::size_t i = 0; i < 4; ++i) row.add(r.reading.adc_codes[i]);
  for (const auto code : r.command.dac_codes) row.add(code);
  if (format.environment) {
    row.add_axes(r.environment_force_N);
    row.add(r.reading.adc_codes[4]);
  }
  return row.finish();
}

LogFile::LogFile(const std::filesystem::path& path, const LogFormat& format, int flush_rows)
    : format_(format), flush_rows_(flush_rows) {
  descriptor_ = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (descriptor_ < 0) throw InputError(path.string() + ": cannot write the log: " + std::strerror(errno));
  buffer_.reserve(static_cast<std::size_t>(flush_rows) * kMaxRow + 2 * kPageBytes);
  buffer_ = log_header(format);
  buffer_ += '\n';
  position_ = buffer_.size();
  write_out();
}

LogFile::~LogFile() {
  close();
}

bool LogFile::add(const StepRecord& record) {
  if (failed()) return false;
  char text[kMaxRow];
  append({text, format_row(record, format_, text)});
  ++rows_;
  return ++waiting_ < flush_rows_ || write_out();
}

void LogFile::append(std::string_view row) {
  const std::size_t left = kPageBytes - (position_ + row.size()) % kPageBytes;
  std::size_t padding = left < kLongestRow ? left : 0;
  position_ += row.size() + padding;
  if (padding == 0) {
    buffer_ += row;
    return;
  }
  const std::string_view time = row.substr(0, row.find(','));
  const bool has_point = time.find('.') != std::string_view::npos;
  // A whole number takes a point first; where there is room for one character only, a zero in front does no harm.
  if (!has_point && padding == 1) {
    buffer_ += '0';
    padding = 0;
  }
  buffer_ += time;
  if (!has_point && padding > 0) {
    buffer_ += '.';
    --padding;
  }
  buffer_.append(padding, '0');
  buffer_ += row.substr(time.size());
}

bool LogFile::flush() {
  return !failed() && write_out();
}

bool LogFile::write_out() {
  std::size_t done = 0;
  while (done < buffer_.size()) {
    const auto written = ::write(descriptor_, buffer_.data() + done, buffer_.size() - done);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) {
      error_ = written < 0 ? errno : ENOSPC;
      break;
    }
    done += static_cast<std::size_t>(written);
  }
  if (error_ != 0 && done > 0) {
    // A full disk may take half a row: cut the file back to its last whole one.
    const std::size_t line_end = buffer_.rfind('\n', done - 1);
    const std::size_t whole = line_end == std::string::npos ? 0 : line_end + 1;
    const auto size = ::lseek(descriptor_, 0, SEEK_CUR);
    if (size >= 0 && ::ftruncate(descriptor_, size - static_cast<off_t>(done - whole)) != 0) errno = 0;
  }
  buffer_.clear();
  waiting_ = 0;
  return error_ == 0;
}

bool LogFile::close() {
  if (descriptor_ < 0) return !failed();
  if (!failed()) write_out();
  if (::close(descriptor_) != 0 && error_ == 0) error_ = errno;
  descriptor_ = -1;
  return !failed();
}

std::string LogFile::error() const {
  return std::strerror(error_);
}

}  // namespace handloop::device
