#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>

#include "control/margins.h"
#include "models/arm.h"

/// All three axes of the tip at once. The device's inertia couples them wherever the pose is not the home pose; each
/// axis has its own arm and its own wall. Indices are the hand's axes: 0 = x left-right, 1 = y up-down, 2 = z
/// forward-backward.
namespace handloop::control {

struct MultiAxisPlant {
  Eigen::Matrix3d tip_inertia_kg = 0.075 * Eigen::Matrix3d::Identity();  ///< symmetric, positive definite
  Eigen::Matrix3d tip_damping_Ns_per_m = 0.05 * Eigen::Matrix3d::Identity();
  std::array<std::optional<models::ArmParameters>, 3> arms;
};

struct MultiAxisMargins {
  bool stable = false;
  double rho = Margins::kNone;
  /// Disk margin of all loops at once, each perturbed on its own: 2/max mu(S - T) with three complex blocks (Seiler,
  /// Packard and Gahinet 2020). Exact: for three blocks the upper bound of AB13MD is mu.
  double disk_alpha = Margins::kNone;
  double disk_at_rad_per_s = Margins::kNone;
  /// Direction at the tip along which the loops are nearest to ringing there, a unit vector over the hand's axes
  /// (moduli of the singular vector after scaling), and in words.
  Eigen::Vector3d worst_direction = Eigen::Vector3d::Zero();
  std::string worst_direction_name;
  /// Disk margin of each loop alone, the other two closed.
  std::array<double, 3> one_at_a_time{Margins::kNone, Margins::kNone, Margins::kNone};
};

/// Poles from the coupled state space; mu on a grid refined about its peaks. Gains by axis; an axis with none is open.
/// Throws InputError where timing or inertia is not possible. About half a second.
MultiAxisMargins evaluate(const MultiAxisPlant& plant, const LoopTiming& timing, const std::array<WallGains, 3>& gains);

}  // namespace handloop::control
