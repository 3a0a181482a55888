#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "device/fault.h"
#include "models/scenario.h"
#include "sim/seven_bar_plant.h"

/// The seven-bar linkage with its controller in lock-step, kept in memory: what measurements of it are made of.
namespace handloop::studies {

/// Signals by sample; x forward, y up; positions from home.
struct SevenBarTrace {
  double sample_time_s = 0.0;
  std::vector<double> t_s;
  std::array<std::vector<double>, 2> position_m, desired_m;
  std::array<std::vector<double>, 2> hand_N;         ///< f_h as the sensor says
  std::array<std::vector<double>, 2> environment_N;  ///< f_e as the sensor says, at the handle, weight left out
  std::array<std::vector<double>, 2> muscle_N;
  device::FaultEvent fault;

  std::size_t size() const { return t_s.size(); }
};

struct SevenBarSimulation {
  models::Scenario scenario;
  double duration_s = 1.0;
  bool guarded = true;              ///< false: no limit ends it
  sim::OutsideForce muscle{};       ///< in the place of the scenario's
  sim::OutsideForce environment{};  ///< f_ext, N at the load
  sim::OutsideForce desired{};      ///< added to p_des, m
  std::uint64_t every = 1;          ///< keeps one sample in so many
};
/// Throws InputError where the scenario cannot be simulated.
SevenBarTrace simulate(const SevenBarSimulation& what);

/// Limits so wide that nothing ends a measurement.
models::SafetySettings no_limits();

}  // namespace handloop::studies
