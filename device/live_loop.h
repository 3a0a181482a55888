#pragma once

#include <atomic>
#include <memory>
#include <string>
#include <thread>

#include "control/controllers/virtual_wall.h"
#include "device/device.h"
#include "device/latency.h"
#include "device/loop.h"
#include "device/mailbox.h"
#include "device/realtime.h"
#include "device/ring_buffer.h"
#include "device/timing.h"
#include "models/scenario.h"

namespace handloop::device {

/// What a person watching a loop wants to know; a plain value, posted about thirty times a second.
struct LiveStatus {
  bool running = false;
  std::uint64_t steps = 0;
  double device_time_s = 0.0;
  double real_time_factor = 1.0;  ///< device time over wall time of the last second
  FaultEvent fault;
  std::uint64_t missed_deadlines = 0;
  double p50_us = 0.0, p99_us = 0.0, p99_9_us = 0.0, max_us = 0.0;  ///< of one pass of the loop
  control::VirtualWallGains gains;                                  ///< in force now
};

/// A haptic loop in a thread of its own, for a panel: gains go in through a lock-free mailbox, samples come out through
/// a ring. One thread (the panel's) calls these members; none of them ever makes the loop wait.
///
///   LiveLoop loop(open_device("sim", {scenario}), scenario);
///   loop.start();
///   while (drawing) {
///     loop.set_gains(sliders);
///     while (loop.pop(record)) history.add(record);
///     show(loop.status());
///   }
class LiveLoop {
 public:
  /// Throws InputError where scenario and device do not make a loop.
  LiveLoop(std::unique_ptr<Device> device, const models::Scenario& scenario);
  /// Stops, which zeroes the device.
  ~LiveLoop();
  LiveLoop(const LiveLoop&) = delete;
  LiveLoop& operator=(const LiveLoop&) = delete;

  /// Begins a session from its first sample. Throws what Device::start() throws. Nothing where it runs already.
  void start();
  /// Ends it; the device is at zero when this returns.
  void stop();

  /// Taken at the next sample. Gains that are not possible are ignored there.
  void set_gains(const control::VirtualWallGains& gains) { gains_.post(gains); }
  /// Speed of lock-step devices against real time: 1, or less for slow motion. 0 holds still.
  void set_speed(double speed) { speed_.store(speed, std::memory_order_relaxed); }
  /// One sample while the loop holds still; nothing where it runs.
  void single_step() { single_steps_.store(1, std::memory_order_relaxed); }
  /// Latches a fault: the force ramps to zero.
  void trip() { loop_->trip(Fault::external); }

  /// The next sample not yet seen; false where there is none. Samples that were not fetched for 8 s are lost.
  bool pop(StepRecord& record) { return ring_.pop(record); }
  const LiveStatus& status();

  const Device& device() const { return *device_; }
  Device& device() { return *device_; }
  const models::Scenario& scenario() const { return scenario_; }
  /// Tip at the scenario's pose, device frame, m.
  const Eigen::Vector3d& home_tip_m() const { return home_tip_m_; }
  /// What could not be had of real time; empty where all was granted or start() was not yet called.
  std::string realtime_note() const { return note_ready_.load(std::memory_order_acquire) ? realtime_note_ : ""; }

 private:
  void run();

  std::unique_ptr<Device> device_;
  models::Scenario scenario_;
  std::unique_ptr<control::Mechanism> mechanism_;
  Eigen::Vector3d home_tip_m_;
  control::VirtualWall wall_;
  std::unique_ptr<Loop> loop_;
  RingBuffer<StepRecord, 8192> ring_;
  Mailbox<control::VirtualWallGains> gains_;
  Mailbox<LiveStatus> statuses_;
  LiveStatus status_;
  std::atomic<double> speed_{1.0};
  std::atomic<int> single_steps_{0};
  std::atomic<bool> stop_{false};
  std::string realtime_note_;
  std::atomic<bool> note_ready_{false};
  std::thread thread_;
};

/// Pose of a scenario, rad, and the limits about its tip.
Eigen::Vector3d pose_rad(const models::Scenario& scenario);
LoopConfig loop_config(const models::Scenario& scenario, const Eigen::Vector3d& home_tip_m);

}  // namespace handloop::device
