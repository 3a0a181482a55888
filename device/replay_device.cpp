#include "device/replay_device.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "control/controllers/phantom_mechanism.h"
#include "io/csv_file.h"
#include "io/recording_file.h"
#include "models/errors.h"

namespace handloop::device {
namespace {

constexpr std::array<std::string_view, 12> kLogColumns{"time_s", "sample", "valid", "count_1", "count_2", "count_3",
                                                       "adc_1",  "adc_2",  "adc_3", "adc_4",   "dac_1",   "dac_2"};

std::uint32_t adc_code(const DeviceDescription& d, double volts) {
  const double top = std::ldexp(1.0, d.adc_bits) - 1.0;
  const double code = std::round((volts + d.adc_range_V) / (2.0 * d.adc_range_V) * top);
  return static_cast<std::uint32_t>(std::clamp(code, 0.0, top));
}

}  // namespace

ReplayDevice::ReplayDevice(const DeviceDescription& description, const models::Scenario& scenario,
                           const std::filesystem::path& recording)
    : description_(description) {
  description_.recorded = true;
  const bool is_csv = recording.extension() != ".mat";
  if (!is_csv || !read_log(recording)) read_recording(recording, scenario);
}

bool ReplayDevice::read_log(const std::filesystem::path& path) {
  const io::CsvFile file(path);
  std::vector<std::size_t> columns;
  for (const auto name : kLogColumns) {
    const auto found = file.find(name);
    if (!found) return false;
    columns.push_back(*found);
  }
  columns.push_back(file.require("dac_3"));
  const auto fifth = file.find("adc_5");  // of devices that have one
  if (fifth) columns.push_back(*fifth);
  const auto values = file.read_numbers(columns);
  for (std::size_t row = 0; row < values[0].size(); ++row) {
    Reading r;
    r.time_ns = std::llround(values[0][row] * 1e9);
    r.sample = static_cast<std::uint64_t>(values[1][row]);
    r.valid = values[2][row] != 0.0;
    for (std::size_t i = 0; i < 3; ++i) r.encoder_counts[i] = static_cast<std::int32_t>(values[3 + i][row]);
    for (std::size_t i = 0; i < 4; ++i) r.adc_codes[i] = static_cast<std::uint32_t>(values[6 + i][row]);
    if (fifth) r.adc_codes[4] = static_cast<std::uint32_t>(values[13][row]);
    Command c;
    c.sample = r.sample;
    for (std::size_t i = 0; i < 3; ++i) c.dac_codes[i] = static_cast<std::uint32_t>(values[10 + i][row]);
    readings_.push_back(r);
    commands_.push_back(c);
  }
  if (readings_.empty()) throw InputError(path.string() + ": the log holds no sample");
  return true;
}

void ReplayDevice::read_recording(const std::filesystem::path& path, const models::Scenario& scenario) {
  const auto recording = io::read_recording(path);
  if (recording.rotary) throw InputError(path.string() + ": an angle and a torque cannot be replayed on the Phantom");
  if (std::abs(recording.sample_time_s - description_.sample_time_s) > 1e-3 * description_.sample_time_s) {
    throw InputError(fmt::format("{}: is sampled every {} s, the scenario every {} s; set loop.sample_time_s",
                                 path.string(), recording.sample_time_s, description_.sample_time_s));
  }
  const auto& device = scenario.device;
  const auto lengths = models::phantom_parameters(device.parameter_set, device.stylus_mass_kg);
  const Eigen::Vector3d home(device.pose_rad[0], device.pose_rad[1], device.pose_rad[2]);
  const Eigen::Vector3d home_tip = models::phantom_tip(lengths, home);
  const int row = models::device_row(scenario.wall.axis);
  for (std::size_t k = 0; k < recording.size(); ++k) {
    Eigen::Vector3d tip = home_tip;
    tip[row] += recording.position_m[k];
    Eigen::Vector3d q;
    try {
      q = models::phantom_inverse(lengths, tip);
    } catch (const InputError& error) {
      throw InputError(fmt::format("{}: sample {}: {}", path.string(), k, error.what()));
    }
    Reading r;
    r.sample = k;
    r.time_ns = std::llround(static_cast<double>(k) * description_.sample_time_s * 1e9);
    r.valid = true;
    for (std::size_t i = 0; i < 3; ++i) {
      const double turned = (q[static_cast<Eigen::Index>(i)] - description_.encoder_zero_rad[i]) *
                            description_.transmission_ratio[i] / description_.encoder_rad_per_count[i];
      r.encoder_counts[i] = static_cast<std::int32_t>(std::floor(turned));
      const double force_N = static_cast<int>(i) == row ? recording.force_N[k] : 0.0;
      r.adc_codes[i] = adc_code(description_, force_N / description_.analog_N_per_V[i]);
    }
    const double grip_N = recording.grip_force_N.empty() ? 0.0 : recording.grip_force_N[k];
    r.adc_codes[3] = adc_code(description_, grip_N / description_.analog_N_per_V[3]);
    readings_.push_back(r);
  }
  // Force channels that were not recorded are constant: no sign of a dead sensor.
  description_.ideal = true;
}

void ReplayDevice::start() {
  next_ = 0;
  different_ = 0;
}

Reading ReplayDevice::read() {
  if (next_ < readings_.size()) return readings_[next_];
  Reading over = readings_.back();
  over.valid = false;
  return over;
}

bool ReplayDevice::write(const Command& command) {
  if (next_ < commands_.size() && commands_[next_].dac_codes != command.dac_codes) ++different_;
  ++next_;
  return true;
}

}  // namespace handloop::device
