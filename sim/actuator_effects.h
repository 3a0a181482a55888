#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "models/scenario.h"
#include "sim/phantom_scene.h"
#include "sim/signal_path.h"

namespace handloop::sim {

/// Effects on the actuator's signal. They act on the commanded force at the tip along their axis; here is what they add
/// to it at the stages of a step. Real-time safe after construction.
class ActuatorEffects {
 public:
  ActuatorEffects() = default;
  /// Throws InputError where an effect cannot be simulated.
  ActuatorEffects(const models::Scenario& scenario, double step_s);

  void reset();
  /// A step begins, the joint torques held over it.
  void begin_step(double t_s, const TipState& tip, const Eigen::Vector3d& torque_Nm);
  /// Force added at the tip, by row of the device frame, at stage 0 to 3.
  const Eigen::Vector3d& added_N(int stage) const { return stage == 0 ? start_ : stage == 3 ? end_ : middle_; }
  const Eigen::Vector3d& added_at_end_N() const { return end_; }

 private:
  /// Mean over one half step of the command as it was a delay ago.
  double delayed(std::size_t axis, std::uint64_t half_step, double now);

  bool any_ = false;
  double half_step_s_ = 0.0;
  std::array<SignalPath, 3> paths_;          ///< by axis, in half steps
  std::array<std::vector<double>, 3> past_;  ///< commanded force of each half step, a ring
  std::uint64_t half_steps_ = 0;
  Eigen::Vector3d start_ = Eigen::Vector3d::Zero(), middle_ = Eigen::Vector3d::Zero(), end_ = Eigen::Vector3d::Zero();
};

/// The effects a scenario puts on one axis.
std::vector<models::EffectPtr> effects_of(const models::Scenario& scenario, models::Axis axis);

}  // namespace handloop::sim
