#pragma once

#include <Eigen/Core>
#include <array>

#include "models/scenario.h"
#include "sim/scene_file.h"

namespace handloop::sim {

/// scenes/phantom.xml, compiled and set up as a scenario says, with the places the plant needs.
struct PhantomScene {
  ModelPtr model;
  std::array<int, 3> motor_dof{};  ///< q1, q2, q3 (absolute angles); qpos and dof addresses are the same here
  int elbow_dof = 0;               ///< q3 - q2 on the forearm's side of the loop
  int coupler_dof = 0;             ///< q2 - q3 on the crank's side
  int tip_site = 0;
  int hand_mocap = 0, lower_arm_mocap = 0, upper_arm_mocap = 0, wall_mocap = 0;
  double upper_link_m = 0.0;  ///< l1
  double forearm_m = 0.0;     ///< l2
  double crank_m = 0.0;       ///< l3
  double stylus_mass_kg = 0.0;
  std::array<double, 3> rotor_kg_m2{};  ///< at the joint, split from the links where the structure is elastic
};

/// Loads the scene and applies the device settings: parameter set, stylus mass, friction, counterweight, elastic
/// structure. Throws InputError.
PhantomScene load_phantom(const models::DeviceSettings& settings, bool with_visuals);

/// Position of the tip (device frame), its velocity and Jacobian, and the part of its acceleration that comes of
/// velocity alone; by the chain turret - upper link - forearm, whose angles are q1, q2 and q2 + elbow.
struct TipState {
  Eigen::Vector3d position_m;
  Eigen::Vector3d velocity_m_per_s;
  Eigen::Matrix3d jacobian;  ///< by q1, q2 and the forearm's absolute angle
  Eigen::Vector3d bias_m_per_s2;
};
TipState tip_state(const PhantomScene& scene, const double* qpos, const double* qvel);
/// The same with the forearm's angle given: motor angles q1, q2, q3 and their rates.
TipState tip_state(const PhantomScene& scene, const Eigen::Vector3d& q, const Eigen::Vector3d& qdot);

}  // namespace handloop::sim
