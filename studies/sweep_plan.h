#pragma once

#include <cstdint>
#include <vector>

#include "studies/sweep.h"

namespace handloop::studies {

/// What the wall meets besides the arm: one for each axis, delay and device.
struct SweepCondition {
  models::Axis axis = models::Axis::z;
  int delay_samples = 1;
  int device = 0;               ///< 0: nominal
  double mass_factor = 1.0;     ///< of the device's tip inertia
  double damping_factor = 1.0;  ///< of the device's viscous damping

  bool operator==(const SweepCondition&) const = default;
};

/// A place where the whole sample of arms is judged.
struct SweepPoint {
  std::uint32_t condition = 0;
  int stage = 0;  ///< adaptive: which refinement asked for it
  double stiffness_N_per_m = 0.0;
  double damping_Ns_per_m = 0.0;

  bool operator==(const SweepPoint&) const = default;
};

/// A share of the work, handed out, computed and committed as one: some arms at some neighbouring points of one
/// condition.
struct SweepBlock {
  std::uint32_t first_point = 0, point_count = 0;
  std::uint64_t first_arm = 0, arm_count = 0;

  std::uint64_t evaluations() const { return point_count * arm_count; }
};

/// Every condition of the settings, in the order axis, delay, device.
std::vector<SweepCondition> sweep_conditions(const SweepSettings& settings);

/// Points of the first stage: all of them unless the design is adaptive.
std::vector<SweepPoint> first_points(const SweepSettings& settings, std::size_t conditions);

/// Adaptive: the points to add after a stage, given the share of stable arms at every point so far, in the order of
/// `points`; empty when the boundary is as fine as asked for. Cells of the grid (of any level) whose corners lie on
/// both sides of the boundary are halved in both directions.
std::vector<SweepPoint> next_points(const SweepSettings& settings, std::size_t conditions,
                                    const std::vector<SweepPoint>& points, const std::vector<double>& stable_share,
                                    int stage);

/// Cuts points [from, size) into blocks of about `target` evaluations. Blocks never span two conditions; where every
/// block may hold whole points it does (`whole_points`), however many arms there are.
std::vector<SweepBlock> cut_blocks(const std::vector<SweepPoint>& points, std::size_t from, std::uint64_t arms,
                                   std::uint64_t target, bool whole_points);

}  // namespace handloop::studies
