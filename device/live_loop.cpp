#include "device/live_loop.h"

#include <cmath>
#include <limits>

#include "control/controllers/phantom_mechanism.h"

namespace handloop::device {
namespace {

constexpr std::int64_t kStatusEvery_ns = 30'000'000;
constexpr std::int64_t kStill_ns = 5'000'000;

}  // namespace

Eigen::Vector3d pose_rad(const models::Scenario& scenario) {
  const auto& q = scenario.device.pose_rad;
  return {q[0], q[1], q[2]};
}

LoopConfig loop_config(const models::Scenario& scenario, const Eigen::Vector3d& home_tip_m) {
  LoopConfig config;
  config.limits = safety_limits(scenario, home_tip_m);
  config.delay_samples = scenario.loop.delay_samples;
  config.states = state_limits(scenario.safety);
  config.states.against_model = config.limits.watch_encoders;
  if (scenario.device.model == models::DeviceModel::seven_bar) {
    // Its controller asks for positions, not for a force that sensor and encoders could be compared with: that is what
    // the state monitor's model is for.
    config.limits.mismatch_force_N = config.limits.stuck_force_N = std::numeric_limits<double>::infinity();
    config.limits.watch_encoders = false;
  }
  return config;
}

LiveLoop::LiveLoop(std::unique_ptr<Device> device, const models::Scenario& scenario)
    : device_(std::move(device)),
      scenario_(scenario),
      mechanism_(control::make_mechanism(scenario.device)),
      home_tip_m_(mechanism_->at(pose_rad(scenario)).tip_m),
      wall_(control::make_virtual_wall(scenario, home_tip_m_)),
      loop_(std::make_unique<Loop>(loop_config(scenario, home_tip_m_), device_->description(), *mechanism_, wall_)) {}

LiveLoop::~LiveLoop() {
  stop();
}

void LiveLoop::start() {
  if (thread_.joinable()) return;
  loop_->reset();
  StepRecord old;
  while (ring_.pop(old)) {
  }
  device_->start();
  stop_.store(false);
  thread_ = std::thread([this] { run(); });
}

void LiveLoop::stop() {
  stop_.store(true);
  if (thread_.joinable()) thread_.join();
}

const LiveStatus& LiveLoop::status() {
  statuses_.take(status_);
  return status_;
}

void LiveLoop::run() {
  // A panel shares the machine with its loop: locked memory and priority only where a real device waits.
  if (!device_->lock_step()) {
    const auto grant = request_realtime();
    if (!note_ready_.load(std::memory_order_relaxed)) {
      for (const auto& line : grant.refused) realtime_note_ += line + "\n";
      note_ready_.store(true, std::memory_order_release);
    }
  }
  MonotonicClock clock;
  const auto period_ns = static_cast<double>(std::llround(device_->description().sample_time_s * 1e9));
  double speed = 1.0;
  Schedule schedule = begin_schedule(clock.now_ns(), static_cast<std::int64_t>(period_ns));
  LatencyHistogram compute;
  LiveStatus status;
  status.running = true;
  std::int64_t last_status_ns = 0, window_ns = clock.now_ns();
  std::uint64_t window_steps = 0;
  std::uint64_t missed_before = 0;
  control::VirtualWallGains gains;
  while (!stop_.load(std::memory_order_relaxed)) {
    const double wanted = device_->lock_step() ? speed_.load(std::memory_order_relaxed) : 1.0;
    bool due = true;
    if (!(wanted > 0.0)) {
      due = single_steps_.exchange(0, std::memory_order_relaxed) > 0;
      if (!due) clock.sleep_until(clock.now_ns() + kStill_ns);
      speed = 0.0;
    } else {
      if (wanted != speed) {
        speed = wanted;
        missed_before += schedule.missed;
        schedule = begin_schedule(clock.now_ns(), static_cast<std::int64_t>(period_ns / speed));
      }
      wait_for_next_cycle(schedule, clock);
      single_steps_.store(0, std::memory_order_relaxed);
    }
    if (due) {
      if (gains_.take(gains)) wall_.set_gains(gains);
      const StepRecord& record = loop_->step(*device_);
      compute.add(record.compute_ns);
      ring_.push(record);
      ++status.steps;
      status.device_time_s = static_cast<double>(record.reading.time_ns) * 1e-9;
    }
    const std::int64_t now_ns = clock.now_ns();
    if (now_ns - last_status_ns < kStatusEvery_ns) continue;
    last_status_ns = now_ns;
    if (now_ns - window_ns > 1'000'000'000) {
      status.real_time_factor =
          static_cast<double>(status.steps - window_steps) * period_ns / static_cast<double>(now_ns - window_ns);
      window_ns = now_ns;
      window_steps = status.steps;
    }
    status.fault = loop_->fault();
    status.missed_deadlines = missed_before + schedule.missed;
    status.p50_us = compute.percentile_us(0.5);
    status.p99_us = compute.percentile_us(0.99);
    status.p99_9_us = compute.percentile_us(0.999);
    status.max_us = compute.max_us();
    status.gains = wall_.gains();
    statuses_.post(status);
  }
  try {
    device_->stop();
  } catch (...) {
    // The session is over in any case.
  }
  status.running = false;
  statuses_.post(status);
}

}  // namespace handloop::device
