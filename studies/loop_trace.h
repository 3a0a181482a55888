#pragma once

#include <string>
#include <vector>

#include "models/scenario.h"

/// A closed loop on the simulated device, kept in memory: what a plot of it needs.
namespace handloop::studies {

/// One run along the wall's axis (models::Axis), positions from the wall's plane and positive into the wall.
struct LoopTrace {
  std::vector<double> t_s;
  std::vector<double> position_m;    ///< of the tip, as the controller knows it from its encoders
  std::vector<double> wall_force_N;  ///< written to the motors, positive into the wall (a wall pushes back: negative)
  std::vector<double> hand_force_N;  ///< of the device on the hand, as the force sensor reads it
  std::string fault;                 ///< "" where the run went through, else what ended it, in words
  double fault_at_s = 0.0;
  double steps_per_s = 0.0;  ///< of this machine; not repeatable
};

/// Runs the scenario in lock-step with the controller that a device would have, through encoders, converters and the
/// safety envelope. Throws InputError where the scenario cannot be simulated.
LoopTrace trace_loop(const models::Scenario& scenario);

}  // namespace handloop::studies
