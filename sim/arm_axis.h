#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "models/axis_model.h"
#include "models/scenario.h"
#include "sim/delay_line.h"
#include "sim/exponential_step.h"

namespace handloop::sim {

/// What the arm of one axis feels at an instant of a step.
struct AxisMotion {
  double t_s = 0.0;
  double grip_m = 0.0;  ///< of the stylus, from the pose
  double grip_m_per_s = 0.0;
  double rest_m = 0.0;  ///< of the resting body (slow voluntary motion)
  double rest_m_per_s = 0.0;
  double muscle_N = 0.0;  ///< on the arm's mass, positive along the axis
};

/// What the stylus must push along the axis to move as it does: force_N + inertia_kg times its acceleration. It is what
/// a sensor at the grip feels; of the force, grasp_N goes through the grasp into the arm.
struct AxisReaction {
  double force_N = 0.0;
  double inertia_kg = 0.0;  ///< added masses at grasp and joint, which move with the grip
  double grasp_N = 0.0;
};

/// The arm of one axis with its force effects, as a system the stylus drives: stylus motion in, reaction out. The
/// five-parameter arm is integrated in the stages of a fourth-order Runge-Kutta step so that it can share every stage
/// with MuJoCo; its linear part is exact (exponential_step.h). With a massless stylus all force passes the grasp. A
/// rigid hand
/// (`msd`) has no motion of its own. After construction nothing allocates, locks or throws.
class ArmAxis {
 public:
  /// Effects acting on signals are ignored here. Where the scenario attaches no arm, only effects between stylus and
  /// ground act.
  ArmAxis(const models::ArmSettings& settings, models::Axis axis, const std::vector<models::EffectPtr>& effects,
          double step_s);

  void reset();
  /// Puts the arm's mass somewhere, its effects at rest.
  void place(double position_m, double velocity_m_per_s) { state_ << position_m, velocity_m_per_s; }
  /// Remembers the motion at the beginning of a step, for effects that feel it late.
  void remember(const AxisMotion& start);
  /// Reaction and rates at stage 0..3 with the stylus as given; stage 0 sees the step's beginning.
  AxisReaction evaluate(int stage, const AxisMotion& motion);
  /// Moves to the state of stage 1, 2, 3, or with 4 to the end of the step.
  void advance_to(int stage);
  /// Reaction at the present state without touching anything.
  AxisReaction reaction(const AxisMotion& motion) const;

  /// Of the arm's mass.
  double position_m() const { return state_[0]; }
  double velocity_m_per_s() const { return state_[1]; }
  /// Kinetic energy of the mass and potential energy of both springs, effects left out.
  double energy_J(const AxisMotion& motion) const;

 private:
  struct Acting {
    models::EffectPtr effect;
    models::PortBase base;
    DelayLine past;
    std::size_t first_state = 0;
  };
  AxisReaction balance(const AxisMotion& motion, double& mass_m_per_s2) const;
  models::PortMotion port(const Acting& acting, const AxisMotion& motion) const;
  std::span<const double> states_of(const Acting& acting) const;

  enum class Kind { none, arm, rigid };
  models::AxisModel model_;
  Kind kind_;
  double step_s_;
  ExponentialStep exponential_;
  std::vector<Acting> effects_;
  Eigen::Vector2d start_ = Eigen::Vector2d::Zero(), state_ = Eigen::Vector2d::Zero();
  Eigen::Vector2d nonlinear_[4];
  std::vector<double> effect_start_, effect_state_;
  std::vector<double> effect_rates_[4];
};

}  // namespace handloop::sim
