#pragma once

#include <string>
#include <vector>

#include "device/comedi/board_list.h"
#include "device/latency.h"
#include "device/realtime.h"
#include "device/timing.h"
#include "studies/progress.h"

namespace handloop::studies {

/// What this machine can do for a haptic loop, measured.
struct Diagnosis {
  char grade = 'E';                    ///< A to E, see grade_text()
  std::vector<std::string> reasons{};  ///< why not better; empty for A
  double seconds = 0.0;
  device::LatencyHistogram wake{};  ///< lateness of 1 kHz wake-ups
  device::Schedule timing{};
  device::LatencyHistogram loop{};  ///< one pass of the loop on the simulated device, without the device
  double sim_steps_per_s = 0.0;
  device::RealtimeGrant realtime{};
  std::string kernel{};
  bool realtime_kernel = false;
  unsigned processors = 0;
  std::string governor{};      ///< of processor 0; "" where the system does not say
  double steal_percent = 0.0;  ///< time another virtual machine took meanwhile
  std::string opengl{};        ///< renderer and version; "" where there is none
  std::string opengl_problem{};
  std::vector<device::comedi::BoardInfo> boards{};
  std::string gnuplot{};  ///< version; "" where it is missing
};

/// Measures for `seconds` (wake-ups at 1 kHz, real-time priority where permitted), then looks round.
Diagnosis diagnose(double seconds, const Progress& progress = {});

/// A: wake-ups never later than 50 us, with real-time priority and locked memory. B: never later than 200 us.
/// C: no deadline of 1 ms missed. D: fewer than one in a thousand missed. E: more.
char grade(const device::LatencyHistogram& wake, const device::Schedule& timing, const device::RealtimeGrant& realtime,
           std::vector<std::string>& reasons);
std::string grade_text(char grade);

/// Machine form of it.
std::string diagnosis_json(const Diagnosis& diagnosis);

}  // namespace handloop::studies
