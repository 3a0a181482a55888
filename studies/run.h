#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "device/session.h"
#include "models/scenario.h"

/// The closed loop on one device, from start to end, with its log, numbers and pictures.
namespace handloop::studies {

struct RunOptions {
  models::Scenario scenario;
  std::string device = "sim";  ///< see device::open_device
  bool realtime = false;       ///< paced by the wall clock, with real-time priority where permitted
  std::filesystem::path out;
  std::optional<std::filesystem::path> key{};  ///< udp: authenticate packets
  std::string inject{};                        ///< "NAME@SAMPLE": break the device on purpose
  const std::atomic<bool>* stop = nullptr;     ///< ends the run early
};

struct RunOutcome {
  device::SessionResult session;
  std::string device;
  bool stable = false;
  std::string why_unstable;  ///< "" where stable
  double duration_s = 0.0;   ///< of the device's time
  double sim_steps_per_s = 0.0;
  double real_time_factor = 0.0;
  std::vector<std::string> realtime_refused;
  std::vector<std::string> notes;
  std::string log_error;  ///< "" unless the log could not be written
};

/// Writes log.csv, summary.json and report.html, and after a fault fault.csv (the last 2 s), to options.out; everything
/// appears when the run is over. While it lasts, and after a kill -9, the log stands in a hidden directory beside it
/// (".NAME.PID-N.part/log.csv"), complete up to the last tenth of a second.
/// Throws InputError for what cannot be run and RequirementError where the device is not there. A fault is no
/// exception: it is in the outcome.
RunOutcome run(const RunOptions& options);

/// One line about the fault: what, how much, when.
std::string describe(const device::FaultEvent& fault);

}  // namespace handloop::studies
