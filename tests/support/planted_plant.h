#pragma once

#include <string>
#include <vector>

/// The plant of the other laboratory: the two-storey arm (grip - grasp - mass - body) with everything that may be wrong
/// with it, integrated by RK4 at a fine step.
namespace handloop::tests {

struct Plant {
  // the arm: F at the grip -> grasp (k1, b1) -> M -> (k2, b2) -> body; k1 = 0: no grasp, the force acts on the mass
  double M = 0, k1 = 0, k2 = 0, b1 = 0, b2 = 0;

  double grip_mass = 0;  // beyond the sensor; 0: massless grip
  double force_offset = 0;

  enum class Friction { none, smooth, exact, bristle } friction = Friction::none;
  double friction_force = 0, breakaway_excess = 0, stribeck_velocity = 0.01;
  double smoothing_velocity = 1e-3;  // smooth: tanh(v / this)
  double bristle_length = 3e-5;      // bristle (Dahl): slides after this

  double drag = 0;  // |v| v
  double cubic_arm = 0, cubic_grasp = 0;
  double side_stiffness = 0, side_corner = 0;  // extra spring where x > 0, corner rounded over side_corner
  double gap = 0;                              // full width of the dead zone of the grasp's spring

  double bw_force = 0, bw_length = 1e-3, bw_beta = 0.5, bw_gamma = 0.5, bw_exponent = 1;
  double maxwell_stiffness = 0, maxwell_time = 0.1;
  bool maxwell_in_grasp = false;

  double reflex_gain = 0, reflex_delay = 0.04, reflex_rate = 12.0 /* rad/s */;
  int reflex_order = 1;
  bool reflex_rectified = false, reflex_of_position = false;
  double reflex_direction = 1;  // the half that a rectified reflex answers to

  double transport_delay = 0, lag_time = 0;
  double absorber_mass = 0, absorber_rate = 60 /* rad/s */, absorber_damping = 0.05;
  double mode_compliance = 0, mode_rate = 90, mode_damping = 0.05;  // added to the grip's motion

  double ripple_force = 0, ripple_period = 4e-3, ripple_phase = 0;
  bool ripple_at_grip = false;

  enum class Drifts { none, k2, b2, k1, M } drifts = Drifts::none;
  enum class DriftShape { linear, exponential, step } drift_shape = DriftShape::linear;
  double drift_amount = 0, drift_time = 20, drift_duration = 60;

  double tremor_force = 0;                       // times the tremor signal
  double gravity_moment = 0, gravity_angle = 0;  // moment * sin(x + angle): a pendulum

  // outside the catalogue
  double stop_stiffness = 0, stop_at = 0;
  bool stop_two_sided = false;
  double absx_damping = 0, x2_damping = 0;                // |x| v, x^2 v
  double speed_stiffness = 0;                             // |v| x
  double absx_friction = 0;                               // |x| sign(v)
  double arm_freeplay = 0;                                // dead zone of k2's spring, full width
  double saturating_force = 0, saturating_length = 2e-3;  // F tanh(x / length)
  double forward_stiffness = 0;                           // x where v > 0
  double root_damping = 0;                                // sqrt|v| sign(v)
};

/// What drives a run, at 1 / sample_time_s. `tremor` and `equilibrium` (a wander of the body that k2 and b2 hang on)
/// may be empty.
struct Drive {
  std::vector<double> force;
  std::vector<double> tremor;
  std::vector<double> equilibrium;
  double sample_time_s = 0.001;
  bool held = true;           ///< force held over each sample; else interpolated by a cubic
  int steps_per_sample = 20;  ///< RK4 steps
  std::size_t lead_in = 0;    ///< first samples, run but not returned; drifts start after them
  /// Where not empty the force is made by a position controller, stiffness (reference - x) - damping v, held, plus
  /// `force`.
  std::vector<double> reference;
  double servo_stiffness = 0, servo_damping = 0;
};

/// Position of the grip (through the sensor's lag) at every sample after the lead-in. Empty where the run diverged.
/// `applied`, where given, receives the force of each of these samples.
std::vector<double> run_plant(const Plant& plant, const Drive& drive, std::vector<double>* applied = nullptr);

}  // namespace handloop::tests
