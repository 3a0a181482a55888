#include "device/comedi/comedi_device.h"

#include <algorithm>
#include <cmath>

#include "models/errors.h"

namespace handloop::device::comedi {

ComediDevice::ComediDevice(const ComediConfig& config, const std::array<double, 3>& pose_rad, double sample_time_s)
    : config_(config), encoders_(config.encoders), motors_(config.motors), force_(config.force) {
  description_ = describe(config, pose_rad, sample_time_s, motors_.maxdata(), force_.maxdata());
  if (!motors_.write_zero()) throw InputError(config.motors.board + ": the motors' DACs cannot be set to zero");
}

ComediDevice::~ComediDevice() {
  motors_.write_zero();
}

void ComediDevice::start() {
  encoders_.start();
  if (!motors_.write_zero()) throw InputError(config_.motors.board + ": the motors' DACs cannot be set to zero");
  guardian_ = nullptr;
  guardian_ = std::make_unique<Guardian>(config_.watchdog_s, [this] { return motors_.write_zero(); });
  next_sample_ = 0;
  begin_ns_ = 0;
}

Reading ComediDevice::read() {
  const std::int64_t now_ns = clock_.now_ns();
  const auto period_ns = static_cast<std::int64_t>(std::llround(description_.sample_time_s * 1e9));
  if (begin_ns_ == 0) {
    begin_ns_ = now_ns;
    origin_ns_ = now_ns - period_ns / 2;  // wake-ups may be half a period early or late and still count as their own
  }
  Reading reading;
  reading.sample = std::max(next_sample_, static_cast<std::uint64_t>((now_ns - origin_ns_) / period_ns));
  next_sample_ = reading.sample + 1;
  reading.time_ns = now_ns - begin_ns_;
  reading.valid = encoders_.read(reading.encoder_counts) && force_.read(reading.adc_codes);
  return reading;
}

bool ComediDevice::write(const Command& command) {
  if (guardian_) guardian_->beat();
  return motors_.write(command.dac_codes);
}

void ComediDevice::stop() {
  motors_.write_zero();
  motors_.write_zero();
}

}  // namespace handloop::device::comedi
