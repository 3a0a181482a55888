#pragma once

#include "control/force_control.h"
#include "models/scenario.h"

namespace handloop::control {

/// S_h, S_e and the tracking of G of the primary stabilising controller (controllers/force_amplifier.h) at one pose, in
/// closed form: with mass L at the handle, X = e^(-jwdT) (1 - e^(-jwT))/(jwT) for delay and hold and
/// D = -w^2 + X (k_d V + k_p), V the filtered difference,
///     p/p_ref = X (-w^2 + k_d V + k_p)/D,   S_h = L^-1 (1 - X)/D,   S_e = L^-1/D.
/// Contact forces are mostly mass times acceleration, which the hold keeps over a sample and the sensor sees at its
/// end: they come half a sample late.
/// S_e is of what the computed torque does not carry: forces on the load other than its own inertia and weight.
/// Images of the sampler are neglected (below a hundredth of the sample rate they do not matter).
class ModelledPrimary final : public Sensitivity {
 public:
  /// The device of a scenario at joint angles th3, th6. Throws InputError where the arm is stretched there.
  ModelledPrimary(const models::Scenario& scenario, const Eigen::Vector2d& th_rad);
  Eigen::Matrix2cd to_hand(double frequency_rad_per_s) const override;
  Eigen::Matrix2cd to_environment(double frequency_rad_per_s) const override;
  std::complex<double> sensing(double frequency_rad_per_s) const override;
  Eigen::Matrix2cd tracking(double frequency_rad_per_s) const override;

 private:
  struct Terms {
    std::complex<double> hold, feedback, denominator;
  };
  Terms terms(double frequency_rad_per_s) const;

  Eigen::Matrix2d mobility_per_kg_;
  double bandwidth_, sample_time_s_, delay_s_;
};

/// The loop of a scenario at joint angles th3, th6 with the arm H_0 and the load as the mechanism has it.
ForceControl force_control_of(const models::Scenario& scenario, const Eigen::Vector2d& th_rad);

}  // namespace handloop::control
