#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "models/scenario.h"
#include "sim/actuator_effects.h"
#include "sim/arm_axis.h"
#include "sim/hand_motion.h"
#include "sim/phantom_scene.h"
#include "sim/pull.h"

namespace handloop::sim {

/// The mechanics of the plant: the MuJoCo scene, the arms at its stylus and the elastic capstans, integrated together
/// in the stages of one fourth-order Runge-Kutta step. MuJoCo is asked for accelerations only, stage by stage, so there
/// is no callback and nothing global. After construction nothing allocates, locks or throws.
///
/// Vectors by row are in the device frame; motors are q1, q2, q3.
class PhantomDynamics {
 public:
  /// Throws InputError where the scenario asks for what cannot be simulated.
  PhantomDynamics(const models::Scenario& scenario, bool with_visuals);

  void reset();
  /// Puts motor angles and rates somewhere, the loop closed and the gimbal still; an arm's mass likewise. For
  /// linearisation.
  void place(const Eigen::Vector3d& q_rad, const Eigen::Vector3d& rate_rad_per_s);
  void place_arm(models::Axis axis, double position_m, double velocity_m_per_s);
  /// Torques that carry the device's weight where it is, at rest.
  Eigen::Vector3d holding_torque_Nm();
  /// One sample further, the joint torques (Nm) held. `sample` counts from 0.
  void advance(std::uint64_t sample, const Eigen::Vector3d& torque_Nm);

  /// Somebody else's hand on the stylus, felt from the next step on.
  void set_pull(const Pull& pull) { pull_ = pull; }

  double step_s() const { return step_s_; }
  const PhantomScene& scene() const { return scene_; }
  mjData_* data() { return data_.get(); }
  const Eigen::Vector3d& pose_rad() const { return pose_; }
  const Eigen::Vector3d& tip_at_pose_m() const { return tip_at_pose_; }

  TipState tip() const;
  /// Where the encoder of a motor is: on its rotor, which an elastic structure lets differ from the link.
  double motor_side_rad(std::size_t motor) const;
  double motor_side_rad_per_s(std::size_t motor) const;
  /// Opening of the parallelogram at the crank's end.
  double loop_gap_m() const;
  const ArmAxis& arm(models::Axis axis) const { return arms_[static_cast<std::size_t>(axis)]; }

  /// What the hand (and effects beside it) ask of the tip at the end of the last sample.
  struct Reaction {
    Eigen::Vector3d force_N = Eigen::Vector3d::Zero();
    Eigen::Vector3d inertia_kg = Eigen::Vector3d::Zero();
    Eigen::Vector3d grasp_N = Eigen::Vector3d::Zero();  ///< of it, through the grasp
  };
  Reaction reaction(double t_s, const TipState& tip) const;
  /// Acceleration of the tip under the last torques.
  Eigen::Vector3d tip_acceleration(const TipState& tip, const Reaction& reaction);
  /// Kinetic energy of the device, of the arms and of their springs; gravity left out.
  double energy_J(double t_s);

 private:
  void set_up_structure(const models::DeviceSettings& device);
  AxisMotion motion_of(models::Axis axis, double t_s, const TipState& tip, const HandMotion::Rest& rest,
                       double muscle_N) const;
  void step(double t_s, double share_of_sample);
  void evaluate(int stage, double t_s, double share_of_sample);
  void advance_to(int stage);
  Eigen::Vector3d link_torques(int stage, const TipState& tip, const Eigen::Vector3d& actuator_N);
  Eigen::Vector3d solve(const TipState& tip, const Eigen::Vector3d& reaction_N, const Eigen::Vector3d& inertia_kg,
                        const Eigen::Vector3d& link_torque_Nm);
  /// What a pulling spring asks of the tip, as a reaction.
  Eigen::Vector3d pull_reaction_N(const TipState& tip) const;
  void push_tip(const TipState& tip, const Eigen::Vector3d& force_N);
  void add_tip_inertia(const TipState& tip, const Eigen::Vector3d& mass_kg);

  double sample_time_s_;
  int substeps_;
  double step_s_;
  PhantomScene scene_;
  DataPtr data_;
  HandMotion hand_;
  std::vector<ArmAxis> arms_;  ///< by axis
  ActuatorEffects actuator_;
  Pull pull_;
  Eigen::Vector3d pose_, tip_at_pose_;
  Eigen::Vector3d torque_Nm_ = Eigen::Vector3d::Zero();

  std::vector<double> start_q_, start_v_;
  std::array<std::vector<double>, 4> stage_v_, stage_a_;

  /// Rotors on elastic capstans.
  bool elastic_ = false;
  Eigen::Vector3d spring_Nm_per_rad_, damping_Nms_per_rad_;
  Eigen::Vector3d rotor_rad_, rotor_rad_per_s_, rotor_start_rad_, rotor_start_rate_;
  std::array<Eigen::Vector3d, 4> rotor_rate_, rotor_acceleration_;
};

}  // namespace handloop::sim
