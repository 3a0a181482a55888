#include "device/loop.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "models/errors.h"

namespace handloop::device {
namespace {

// Writes that fail in a row before the device counts as lost; each is tried again with the next sample.
constexpr int kFailedWritesAllowed = 3;
// A device that loses every other sample is no device, even where no gap is long.
constexpr double kMissingShareAllowed = 0.6;
constexpr double kFailedShareAllowed = 0.4;
constexpr double kForget_s = 0.5;

std::int64_t now_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

bool finite(const control::MechanismState& state) {
  return state.tip_m.allFinite() && state.jacobian.allFinite() && state.gravity_torque_Nm.allFinite();
}

}  // namespace

Loop::Loop(const LoopConfig& config, const DeviceDescription& description, const control::Mechanism& mechanism,
           control::Controller& controller)
    : config_(config),
      description_(description),
      mechanism_(mechanism),
      controller_(controller),
      feedforward_bound_Nm_(mechanism.feedforward_bound_Nm()),
      zero_(zero_code(description)),
      limiter_(config.limits, description.sample_time_s),
      observer_(config.limits.energy_J, description.sample_time_s),
      monitor_(config.limits, description),
      encoders_(description.motor_count, description.sample_time_s, config.limits.least_momentum_Ns),
      forces_known_(config.limits.watch_encoders && !description.recorded && description.analog_input_count >= 3),
      state_monitor_(config.states, mechanism, description) {
  if (config.delay_samples < 0 || config.delay_samples > kMaxDelaySamples) {
    throw InputError("loop.delay_samples must be 0 to " + std::to_string(kMaxDelaySamples) + ", not " +
                     std::to_string(config.delay_samples));
  }
  if (!(description.sample_time_s > 0.0)) throw InputError("loop.sample_time_s must be positive");
  reset();
}

void Loop::reset() noexcept {
  controller_.reset();
  limiter_.reset();
  observer_.reset();
  monitor_.reset();
  encoders_.reset();
  state_monitor_.reset();
  unwrap_.reset();
  record_ = {};
  event_ = {};
  requested_.store(Fault::none, std::memory_order_relaxed);
  steps_ = last_sample_ = 0;
  started_ = false;
  samples_without_reading_ = failed_writes_ = 0;
  missing_share_ = failed_share_ = 0.0;
  missing_ = stale_ = clipped_ = 0;
  computed_ = {};
  computed_.codes.fill(zero_);
  held_ = computed_;
  line_.fill(computed_);
  head_ = 0;
  ramp_step_ = ramp_steps_ = 0;
}

const StepRecord& Loop::step(Device& device) noexcept {
  Reading reading;
  bool read_threw = false;
  try {
    reading = device.read();
  } catch (...) {
    read_threw = true;
    reading = {};
  }
  const std::int64_t begin = now_ns();
  if (const Fault wanted = requested_.load(std::memory_order_relaxed); wanted != Fault::none) {
    latch({wanted, steps_, reading.time_ns, 0.0, 0.0});
  }
  if (read_threw) latch({Fault::read_exception, steps_, record_.reading.time_ns, 0.0, 0.0});
  compute(reading);
  record_.step = steps_;
  record_.command = next_command();
  record_.written_force_N = held_.force_N;
  record_.fault = event_.fault;
  record_.compute_ns = now_ns() - begin;
  write(device);
  record_.fault = event_.fault;
  ++steps_;
  return record_;
}

void Loop::compute(const Reading& reading) noexcept {
  // Time goes on through missing samples, so that every row of the log has one.
  const std::int64_t last_time = record_.reading.time_ns;
  record_.reading = reading;
  if (!reading.valid && steps_ > 0) {
    record_.reading.time_ns = last_time + static_cast<std::int64_t>(std::llround(description_.sample_time_s * 1e9));
  }
  record_.clipped = false;
  try {
    take(reading);
  } catch (...) {
    latch({Fault::controller_exception, steps_, record_.reading.time_ns, 0.0, 0.0});
  }
}

void Loop::take(const Reading& reading) {
  const bool fresh =
      reading.valid && (!started_ || (reading.sample > last_sample_ && reading.time_ns >= last_fresh_ns_));
  const double forget = description_.sample_time_s / kForget_s;
  missing_share_ += forget * ((fresh ? 0.0 : 1.0) - missing_share_);
  if (missing_share_ > kMissingShareAllowed) {
    latch({Fault::no_reading, steps_, record_.reading.time_ns, static_cast<double>(samples_without_reading_ + 1),
           static_cast<double>(config_.limits.watchdog_samples)});
  }
  if (!fresh) {
    ++missing_;
    if (reading.valid) ++stale_;
    record_.reading.valid = false;
    if (++samples_without_reading_ > config_.limits.watchdog_samples) {
      latch({Fault::no_reading, steps_, record_.reading.time_ns, static_cast<double>(samples_without_reading_),
             static_cast<double>(config_.limits.watchdog_samples)});
    }
    return;
  }
  const std::uint64_t samples = started_ ? reading.sample - last_sample_ : 1;
  samples_without_reading_ = 0;
  last_sample_ = reading.sample;
  last_fresh_ns_ = reading.time_ns;
  if (samples > static_cast<std::uint64_t>(config_.limits.watchdog_samples) + 1) {
    latch({Fault::loop_stalled, steps_, reading.time_ns, static_cast<double>(samples),
           static_cast<double>(config_.limits.watchdog_samples)});
  }
  take_fresh(reading, samples);
  started_ = true;
}

bool Loop::take_fresh(const Reading& reading, std::uint64_t samples) {
  const Eigen::Vector3d q = joint_angles_rad(description_, unwrap_.update(reading.encoder_counts));
  control::ControllerInput input;
  input.sample = reading.sample;
  input.time_s = static_cast<double>(reading.time_ns) * 1e-9;
  input.joint_rad = q;
  input.mechanism = mechanism_.at(q);
  input.sensed_force_N = mechanism_.hand_force_N(q, sensed_force_N(description_, reading.adc_codes));
  input.environment_force_N = mechanism_.environment_force_N(q, environment_force_N(description_, reading.adc_codes));
  input.grip_force_N = grip_force_N(description_, reading.adc_codes);

  if (!q.allFinite() || !finite(input.mechanism) || !input.sensed_force_N.allFinite()) {
    latch({Fault::not_finite, steps_, reading.time_ns, 0.0, 0.0});
    return false;
  }
  const Eigen::Vector3d tip_step =
      started_ ? Eigen::Vector3d(input.mechanism.tip_m - record_.tip_m) : Eigen::Vector3d(Eigen::Vector3d::Zero());
  const Eigen::Vector3d last_q = record_.joint_rad;
  const Eigen::Vector3d last_sensed = record_.sensed_force_N;
  record_.joint_rad = q;
  record_.tip_m = input.mechanism.tip_m;
  record_.sensed_force_N = input.sensed_force_N;
  record_.environment_force_N = input.environment_force_N;
  record_.grip_force_N = input.grip_force_N;

  FaultEvent seen = monitor_.check(reading, input.mechanism, input.sensed_force_N, held_.force_N, samples);
  record_.velocity_m_per_s = monitor_.velocity_m_per_s();
  record_.energy_J = observer_.update(held_.force_N, tip_step, held_.in_contact);
  if (seen.fault == Fault::none && record_.energy_J > config_.limits.energy_J) {
    seen = {Fault::energy, 0, 0, record_.energy_J, config_.limits.energy_J};
  }
  if (seen.fault == Fault::none) seen = check_encoders(input, samples);
  if (const auto states = check_states(input, samples); seen.fault == Fault::none) seen = states;
  if (seen.fault != Fault::none) {
    seen.sample = steps_;
    seen.time_ns = reading.time_ns;
    latch(seen);
  }
  // After a fault the controller rests: its force would go nowhere.
  record_.wanted_force_N.setZero();
  record_.limited_force_N.setZero();
  record_.in_contact = false;
  if (event_.fault != Fault::none) return false;

  for (std::uint64_t k = 1; k < samples; ++k) {
    const double share = static_cast<double>(k) / static_cast<double>(samples);
    control::ControllerInput between = input;
    between.sample = reading.sample - samples + k;
    between.time_s = input.time_s - static_cast<double>(samples - k) * description_.sample_time_s;
    between.joint_rad = last_q + share * (q - last_q);
    between.mechanism = mechanism_.at(between.joint_rad);
    between.sensed_force_N = last_sensed + share * (input.sensed_force_N - last_sensed);
    controller_.step(between);
  }
  const control::ControllerOutput output = controller_.step(input);
  if (!output.force_N.allFinite() || !output.feedforward_torque_Nm.allFinite()) {
    latch({Fault::not_finite, steps_, reading.time_ns, 0.0, 0.0});
    return false;
  }
  record_.wanted_force_N = output.force_N;
  record_.limited_force_N = limiter_.limit(output.force_N, record_.clipped);
  record_.in_contact = output.in_contact;
  if (record_.clipped) ++clipped_;
  const Eigen::Vector3d feedforward =
      output.feedforward_torque_Nm.cwiseMax(-feedforward_bound_Nm_).cwiseMin(feedforward_bound_Nm_);
  const Eigen::Vector3d torque = input.mechanism.jacobian.transpose() * record_.limited_force_N + feedforward;
  computed_.force_N = record_.limited_force_N;
  computed_.in_contact = record_.in_contact;
  for (std::size_t i = 0; i < kMaxMotors; ++i) {
    computed_.codes[i] =
        i < description_.motor_count ? torque_code(description_, i, torque[static_cast<Eigen::Index>(i)]) : zero_;
  }
  return true;
}

FaultEvent Loop::check_encoders(const control::ControllerInput& input, std::uint64_t samples) noexcept {
  if (!forces_known_ || samples > static_cast<std::uint64_t>(config_.limits.watchdog_samples) + 1) return {};
  if (monitor_.any_force_input_at_end()) {  // says nothing about force
    encoders_.reset();
    return {};
  }
  Eigen::Vector3d torque_Nm = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < description_.motor_count; ++i) {
    torque_Nm[static_cast<Eigen::Index>(i)] = code_torque_Nm(description_, i, held_.codes[i]);
  }
  return encoders_.check(input.joint_rad, input.mechanism, torque_Nm, input.sensed_force_N, samples);
}

FaultEvent Loop::check_states(const control::ControllerInput& input, std::uint64_t samples) noexcept {
  JointSample sample;
  sample.joint_rad = input.joint_rad;
  sample.mechanism = input.mechanism;
  sample.sensed_force_N = input.sensed_force_N;
  sample.environment_force_N = input.environment_force_N;
  for (std::size_t i = 0; i < description_.motor_count; ++i) {
    sample.torque_Nm[static_cast<Eigen::Index>(i)] = code_torque_Nm(description_, i, held_.codes[i]);
  }
  const FaultEvent event = state_monitor_.check(sample, samples);
  record_.model_torque_Nm = state_monitor_.model_torque_Nm();
  return event;
}

void Loop::latch(FaultEvent event) noexcept {
  if (event_.fault != Fault::none) return;
  event_ = event;
  ramp_from_ = held_.codes;
  ramp_step_ = 0;
  const bool ramp = fault_info(event.fault).response == FaultResponse::ramp_to_zero;
  ramp_steps_ = ramp ? static_cast<int>(std::lround(config_.limits.ramp_s / description_.sample_time_s)) : 0;
}

Command Loop::next_command() noexcept {
  Command command;
  command.sample = record_.reading.valid ? record_.reading.sample : last_sample_;
  if (event_.fault == Fault::none) {
    // Into the line at the tail, out at the head: d samples apart.
    const std::size_t d = static_cast<std::size_t>(config_.delay_samples);
    line_[(head_ + d) % line_.size()] = computed_;
    held_ = line_[head_];
    head_ = (head_ + 1) % line_.size();
  } else {
    ++ramp_step_;
    const double share =
        ramp_step_ < ramp_steps_ ? 1.0 - static_cast<double>(ramp_step_) / static_cast<double>(ramp_steps_) : 0.0;
    for (std::size_t i = 0; i < kMaxMotors; ++i) {
      const double above_zero = static_cast<double>(ramp_from_[i]) - static_cast<double>(zero_);
      held_.codes[i] = static_cast<std::uint32_t>(static_cast<std::int64_t>(zero_) + std::llround(share * above_zero));
    }
    held_.force_N.setZero();
    held_.in_contact = false;
  }
  command.dac_codes = held_.codes;
  return command;
}

void Loop::write(Device& device) noexcept {
  record_.command_taken = false;
  Fault failure = Fault::none;
  try {
    record_.command_taken = device.write(record_.command);
    failed_writes_ = record_.command_taken ? 0 : failed_writes_ + 1;
    failed_share_ += description_.sample_time_s / kForget_s * ((record_.command_taken ? 0.0 : 1.0) - failed_share_);
    if (failed_writes_ > kFailedWritesAllowed || failed_share_ > kFailedShareAllowed) failure = Fault::write_failed;
  } catch (...) {
    failure = Fault::write_exception;
  }
  if (failure == Fault::none) return;
  latch({failure, steps_, record_.reading.time_ns, static_cast<double>(failed_writes_),
         static_cast<double>(kFailedWritesAllowed)});
  try {
    device.stop();
  } catch (...) {
    // Nothing is left to try; the next sample writes zero again.
  }
}

}  // namespace handloop::device
