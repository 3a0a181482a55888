#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "device/device.h"
#include "device/record.h"
#include "ui/traces/min_max_ring.h"

namespace handloop::ui {

/// What can be drawn over time. Axes are those of the hand.
enum class Channel : std::size_t {
  position_x,
  position_y,
  position_z,
  force_x,
  force_y,
  force_z,
  wall_force,
  torque_1,
  torque_2,
  torque_3,
  counts_1,
  counts_2,
  counts_3,
  grip_force,
  energy,
  compute,
  last = compute
};
inline constexpr std::size_t kChannels = static_cast<std::size_t>(Channel::last) + 1;

struct ChannelInfo {
  std::string_view name;    ///< "position x"
  std::string_view column;  ///< of a CSV, with its unit: "position_x_m"
  std::string_view unit;    ///< as drawn: "mm"
  std::string_view group;   ///< channels of one group share a plot: "Position"
  double scale;             ///< drawn value = stored value * scale
};
const ChannelInfo& channel_info(Channel channel);

/// Counts of a quantity above zero in classes a tenth of a decade wide, from 0.1 us to 1 s.
class LogHistogram {
 public:
  static constexpr int kPerDecade = 10, kClasses = 70;
  static constexpr double kLowest = 1e-7;
  void add(double value_s);
  std::span<const std::uint64_t> counts() const { return counts_; }
  std::uint64_t total() const { return total_; }
  void clear() { *this = {}; }

 private:
  std::array<std::uint64_t, kClasses> counts_{};
  std::uint64_t total_ = 0;
};

/// What the loop did, kept for drawing: about 17 minutes at 1 kHz. One thread, the window's.
class TraceStore {
 public:
  /// From now on samples are of this device; `home_tip_m` (device frame) is where positions count from.
  void begin(const device::DeviceDescription& description, const Eigen::Vector3d& home_tip_m);
  void add(const device::StepRecord& record);
  void clear();

  std::uint64_t count() const { return channels_[0].count(); }
  std::uint64_t first() const { return channels_[0].first(); }
  double sample_time_s() const { return description_.sample_time_s; }
  const MinMaxRing& operator[](Channel channel) const { return channels_[static_cast<std::size_t>(channel)]; }
  const LogHistogram& compute_times() const { return compute_times_; }

  /// Samples from to to - 1 of these channels: `time_s` from the first sample ever, then a column a channel. Throws
  /// InputError.
  void write_csv(const std::filesystem::path& path, std::span<const Channel> channels, std::uint64_t from,
                 std::uint64_t to) const;

 private:
  device::DeviceDescription description_;
  Eigen::Vector3d home_tip_m_ = Eigen::Vector3d::Zero();
  std::array<MinMaxRing, kChannels> channels_;
  LogHistogram compute_times_;
};

}  // namespace handloop::ui
