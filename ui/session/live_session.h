#pragma once

#include <cstdint>
#include <filesystem>
#include <future>
#include <memory>
#include <string>
#include <vector>

#include "device/black_box.h"
#include "device/live_loop.h"
#include "device/sim_device.h"
#include "models/scenario.h"
#include "sim/pull.h"
#include "ui/background/latest_job.h"
#include "ui/state/arming.h"
#include "ui/traces/trace_store.h"

namespace handloop::ui {

/// The loop that runs beside the window: made, started and watched here, in a thread of its own. New gains reach it
/// between two samples; anything else that changes the plant makes a new loop behind the window, which then takes the
/// place of the old one. A real device is never started but by arm().
class LiveSession {
 public:
  LiveSession();
  ~LiveSession();
  LiveSession(const LiveSession&) = delete;
  LiveSession& operator=(const LiveSession&) = delete;

  /// Once a frame: the scenario in force. Takes what the loop did since.
  void follow(const models::Scenario& scenario, std::uint64_t revision);

  /// "sim", or an address as `run --device` takes it. A running loop is stopped.
  void use_device(const std::string& address);
  const std::string& device_address() const { return address_; }
  bool simulated() const { return address_ == "sim"; }

  // ---- the simulation's clock --------------------------------------------------------------------------------------
  void set_paused(bool paused);
  bool paused() const { return paused_; }
  void single_step();
  void set_speed(double speed);
  double speed() const { return speed_; }
  /// From the first sample again; clears a fault. A real device has to be armed anew.
  void reset();

  // ---- safety ------------------------------------------------------------------------------------------------------
  /// The force goes to zero and stays there until reset().
  void stop();
  Arming& arming() { return arming_; }
  const Arming& arming() const { return arming_; }
  /// Starts a real device after arming() is complete; an error is in problem().
  void start_armed();
  void disarm();

  bool running() const { return loop_ != nullptr; }
  /// Latched: nothing pushes until reset().
  bool faulted() const { return status_.fault.fault != device::Fault::none; }
  bool preparing() const { return making_.busy(); }
  /// The scenario has changes that the running loop will know of only after reset() or arming.
  bool change_waits() const { return remake_; }
  const device::LiveStatus& status() const { return status_; }
  /// What went wrong making or starting the loop, one line; "" where all is well.
  const std::string& problem() const { return problem_; }
  std::string realtime_note() const { return loop_ ? loop_->realtime_note() : std::string(); }

  /// Somebody reaches in; only a simulated device feels it.
  void pull(const sim::Pull& pull);

  const device::StepRecord& last() const { return last_; }
  bool has_record() const { return has_record_; }
  const Eigen::Vector3d& home_tip_m() const { return home_tip_m_; }
  const TraceStore& traces() const { return traces_; }
  /// From 2 s before a fault to a fifth of a second after it, oldest first.
  const std::vector<device::StepRecord>& evidence() const { return evidence_; }
  /// Throws InputError.
  void write_evidence(const std::filesystem::path& path) const;

 private:
  /// Asks for a loop of the scenario, to take the place of the present one when it is ready.
  void make();
  void take_over(std::shared_ptr<device::LiveLoop> loop);
  /// Ends the present loop. A simulation ends behind the window: its last sleep may be long in slow motion.
  void retire();
  void drain();
  bool only_gains_changed(const models::Scenario& to) const;

  std::string address_ = "sim";
  LatestJob<std::shared_ptr<device::LiveLoop>> making_;
  std::shared_ptr<device::LiveLoop> loop_;
  device::SimDevice* sim_ = nullptr;  ///< of loop_, where it is one
  std::vector<std::future<void>> ending_;
  models::Scenario scenario_;  ///< in force
  std::uint64_t revision_ = 0;
  bool paused_ = false;
  double speed_ = 1.0;
  Arming arming_;
  device::LiveStatus status_;
  std::string problem_;
  device::StepRecord last_;
  bool has_record_ = false;
  Eigen::Vector3d home_tip_m_ = Eigen::Vector3d::Zero();
  TraceStore traces_;
  std::unique_ptr<device::BlackBox> black_box_;
  std::vector<device::StepRecord> evidence_;
  std::uint64_t fault_step_ = 0;
  bool remake_ = false;  ///< a change waits for reset() or arming
};

}  // namespace handloop::ui
