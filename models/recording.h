#pragma once

#include <string>
#include <vector>

namespace handloop::models {

/// One uniformly sampled recording of a single axis. Rotary recordings hold Nm and rad in the same fields.
struct Recording {
  std::string name;  ///< where it came from, for messages and reports
  double sample_time_s = 0.001;
  double start_time_s = 0.0;
  std::vector<double> force_N;       ///< at the grip, positive along the axis
  std::vector<double> position_m;    ///< of the grip
  std::vector<double> grip_force_N;  ///< empty where it was not recorded
  std::string force_unit = "N";      ///< N, Nm or as_recorded
  std::string position_unit = "m";   ///< m, rad or as_recorded
  bool rotary = false;

  std::size_t size() const { return force_N.size(); }
};

}  // namespace handloop::models
