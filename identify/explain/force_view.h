#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "identify/explain/candidates.h"

namespace handloop::identify {

/// A place to start a fit from that owes nothing to the base model's fit.
struct ForceStart {
  Variant variant;            ///< gains and shapes set
  models::ArmParameters arm;  ///< grasp as given, the rest found
  double left = 1.0;          ///< share of the force's power (below 15 Hz) that stays unexplained
};

/// The equation-error view of a five-parameter arm under a recorded force: with its grasp (k1, b1) the record gives the
/// motion of the arm's mass, and along it the force is linear in mass, damper, spring, the effects found so far and the
/// gains of a further one. Nothing is simulated, so no fit that bent itself towards a missing effect stands in the way;
/// noise biases it (errors in variables, Soderstrom, Automatica 43 (2007) 939), so it gives starts, not answers.
/// Signals are low-passed at 15 Hz, then filtered and thinned like every error.
class ForceView {
 public:
  /// The prediction must live as long as the view.
  ForceView(const Prediction& prediction, const models::AxisModel& model);

  /// Motion of the fitting part as recorded.
  const Trajectory& motion() const { return motion_; }
  /// The recorded force, and along the motion: acceleration, velocity and displacement of the arm, and the force of
  /// each force effect of the model.
  const Eigen::VectorXd& force() const { return force_; }
  const std::vector<Eigen::VectorXd>& known() const { return known_; }
  /// A signal of the fitting part as this view sees it.
  Eigen::VectorXd seen(std::span<const double> signal) const;
  /// The best gains and arm for a variant with its shapes as given. `left` is 1 where none are admissible.
  ForceStart regress(const Variant& variant) const { return regress(variant, used_gains(variant)); }
  /// The same with only some of its gains, the others zero.
  ForceStart regress(Variant variant, const std::vector<std::size_t>& gains) const;
  /// The model's arm with mass, damper and spring by regression (its first three coefficients).
  models::ArmParameters arm_with(const Eigen::VectorXd& solution) const;

 private:
  Eigen::VectorXd felt_force(const models::AxisModel& through) const;
  Eigen::VectorXd acceleration(const PlaceMotion& at) const;
  Eigen::VectorXd column(const models::Effect& effect) const;

  const Prediction& prediction_;
  models::AxisModel model_;
  Trajectory motion_;
  std::vector<Eigen::VectorXd> known_;
  Eigen::VectorXd force_;
};

}  // namespace handloop::identify
