#pragma once

#include <span>
#include <vector>

#include "identify/hold.h"
#include "models/axis_model.h"

/// Simulation of one axis under a recorded input, made for fitting: the linear part of the model is stepped exactly,
/// the effects act on it as inputs by a predictor and a corrector. Second order in the step for the effects, exact
/// without.
namespace handloop::identify {

enum class DrivenBy {
  force,    ///< the recorded force goes in, the position of the grip comes out
  position  ///< the recorded motion goes in, the force at the grip comes out (inverse model)
};

/// Motion of the grip as the inverse model needs it, one entry a sample.
struct GripMotion {
  std::vector<double> position_m, velocity_m_per_s, acceleration_m_per_s2;
};

/// Motion at the places of the model, one entry a sample.
struct PlaceMotion {
  std::vector<double> x_m, v_m_per_s;
  void resize(std::size_t n) {
    x_m.resize(n);
    v_m_per_s.resize(n);
  }
};

struct Trajectory {
  std::vector<double> output;  ///< position (force-driven) or force (position-driven), sensor and actuator effects in
  PlaceMotion arm, grasp, joint;  ///< filled where keep_motion was asked for
  bool finite = true;             ///< false: the run diverged, the rest of output is meaningless

  const PlaceMotion& at(models::Place place) const;
};

/// State of the arm's mass and the grip at the first sample.
struct InitialState {
  double position_m = 0.0;
  double velocity_m_per_s = 0.0;
};

struct SimulationOptions {
  double sample_time_s = 0.001;
  Hold hold = Hold::first_order;
  InitialState initial = {};
  bool keep_motion = false;
  double start_time_s = 0.0;  ///< time of the first sample, for effects that depend on it
};

/// Position of the grip under the recorded force. Every effect of the model acts except tremor, which no input
/// predicts.
Trajectory simulate_position(const models::AxisModel& model, std::span<const double> force_N,
                             const SimulationOptions& options);

/// Force at the grip that the recorded motion takes.
Trajectory simulate_force(const models::AxisModel& model, const GripMotion& grip, const SimulationOptions& options);

/// The recorded force as the plant would have to receive it for the recorded position, were there no delays, lags and
/// offsets in the signals: those at the sensor are moved to the force, which for a linear plant is the same.
std::vector<double> force_without_signal_effects(const models::AxisModel& model, std::span<const double> force_N,
                                                 double sample_time_s);

/// Motion at the places as the record shows it: the grip as measured, the grasp stretched by the recorded force through
/// k1 and b1, the arm behind it. `output` stays empty; effects are not asked.
Trajectory recorded_motion(const models::AxisModel& model, const GripMotion& grip, std::span<const double> force_N,
                           const SimulationOptions& options);

/// Output of the model's linear part under an extra resisting force at a place: what a small force there changes.
std::vector<double> response_to_force(const models::AxisModel& model, models::Place place,
                                      std::span<const double> force_N, DrivenBy driven_by,
                                      const SimulationOptions& options);

/// Force of an effect along a motion, one entry a sample, a constant added mass left out.
std::vector<double> force_along(const models::AxisModel& model, const models::Effect& effect, const Trajectory& motion,
                                const SimulationOptions& options);

/// First-order change of simulate_position's (or simulate_force's) output when a force effect is added to a model:
/// the effect's force along the motion the model already makes, through the model's linear part.
std::vector<double> first_order_response(const models::AxisModel& model, const Trajectory& motion,
                                         const models::Effect& effect, DrivenBy driven_by,
                                         const SimulationOptions& options);

}  // namespace handloop::identify
