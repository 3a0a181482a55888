#include "ui/traces/trace_store.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "device/scales.h"
#include "io/output.h"
#include "models/axis.h"

namespace handloop::ui {
namespace {

constexpr std::array<ChannelInfo, kChannels> kInfo{{
    {"position x", "position_x_m", "mm", "Position", 1e3},
    {"position y", "position_y_m", "mm", "Position", 1e3},
    {"position z", "position_z_m", "mm", "Position", 1e3},
    {"force x", "force_x_N", "N", "Force on the hand", 1},
    {"force y", "force_y_N", "N", "Force on the hand", 1},
    {"force z", "force_z_N", "N", "Force on the hand", 1},
    {"wall force", "wall_force_N", "N", "Wall force", 1},
    {"torque 1", "torque_1_Nm", "mNm", "Joint torque", 1e3},
    {"torque 2", "torque_2_Nm", "mNm", "Joint torque", 1e3},
    {"torque 3", "torque_3_Nm", "mNm", "Joint torque", 1e3},
    {"encoder 1", "encoder_1_counts", "counts", "Encoders", 1},
    {"encoder 2", "encoder_2_counts", "counts", "Encoders", 1},
    {"encoder 3", "encoder_3_counts", "counts", "Encoders", 1},
    {"grip force", "grip_force_N", "N", "Grip force", 1},
    {"energy given", "energy_J", "mJ", "Energy given to the hand", 1e3},
    {"one pass", "compute_s", "us", "Time of one pass", 1e6},
}};

}  // namespace

const ChannelInfo& channel_info(Channel channel) {
  return kInfo[static_cast<std::size_t>(channel)];
}

void LogHistogram::add(double value_s) {
  const double place = kPerDecade * std::log10(std::max(value_s, kLowest) / kLowest);
  ++counts_[static_cast<std::size_t>(std::clamp(place, 0.0, kClasses - 1.0))];
  ++total_;
}

void TraceStore::begin(const device::DeviceDescription& description, const Eigen::Vector3d& home_tip_m) {
  if (description.sample_time_s != description_.sample_time_s) clear();
  description_ = description;
  home_tip_m_ = home_tip_m;
  compute_times_.clear();
}

void TraceStore::clear() {
  for (auto& channel : channels_) channel.clear();
  compute_times_.clear();
}

void TraceStore::add(const device::StepRecord& record) {
  const auto put = [this](Channel channel, double value) {
    channels_[static_cast<std::size_t>(channel)].add(static_cast<float>(value));
  };
  for (const auto axis : models::kAxes) {
    const int row = models::device_row(axis);
    const auto offset = static_cast<std::size_t>(axis);
    channels_[static_cast<std::size_t>(Channel::position_x) + offset].add(
        static_cast<float>(record.tip_m[row] - home_tip_m_[row]));
    channels_[static_cast<std::size_t>(Channel::force_x) + offset].add(static_cast<float>(record.sensed_force_N[row]));
  }
  put(Channel::wall_force, record.wanted_force_N.norm());
  for (std::size_t motor = 0; motor < 3; ++motor) {
    const bool there = motor < description_.motor_count;
    channels_[static_cast<std::size_t>(Channel::torque_1) + motor].add(
        static_cast<float>(there ? device::code_torque_Nm(description_, motor, record.command.dac_codes[motor]) : 0.0));
    channels_[static_cast<std::size_t>(Channel::counts_1) + motor].add(
        static_cast<float>(record.reading.encoder_counts[motor]));
  }
  put(Channel::grip_force, record.grip_force_N);
  put(Channel::energy, record.energy_J);
  put(Channel::compute, 1e-9 * static_cast<double>(record.compute_ns));
  compute_times_.add(1e-9 * static_cast<double>(record.compute_ns));
}

void TraceStore::write_csv(const std::filesystem::path& path, std::span<const Channel> channels, std::uint64_t from,
                           std::uint64_t to) const {
  from = std::max(from, first());
  to = std::min(to, count());
  io::OutputFile file(path);
  std::string text = "time_s";
  for (const auto channel : channels) (text += ',') += channel_info(channel).column;
  text += '\n';
  for (std::uint64_t i = from; i < to; ++i) {
    fmt::format_to(std::back_inserter(text), "{:.9g}", static_cast<double>(i) * sample_time_s());
    for (const auto channel : channels) fmt::format_to(std::back_inserter(text), ",{:.9g}", (*this)[channel][i]);
    text += '\n';
    if (text.size() > 65536) {
      file.write(text);
      text.clear();
    }
  }
  file.write(text);
  file.commit();
}

}  // namespace handloop::ui
