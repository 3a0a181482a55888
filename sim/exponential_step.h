#pragma once

#include <Eigen/Core>

namespace handloop::sim {

/// One step of a pair of states y' = L y + N, L constant, by the exponential fourth-order Runge-Kutta method of Cox and
/// Matthews (J. Comput. Phys. 176 (2002) 430, eqs. 26-29): the linear part is exact however fast it is, so an arm of
/// 0.3 g needs no shorter step than one of 300 g. With L = 0 it is the classical method, stage by stage, so states
/// integrated that way and this way can be coupled at every stage.
class ExponentialStep {
 public:
  ExponentialStep() = default;
  /// step in s, of the whole step. Throws std::invalid_argument where L or its exponential is not finite.
  ExponentialStep(const Eigen::Matrix2d& linear, double step_s);

  /// State at which stage 1, 2 or 3 is evaluated (0: the start itself), from the start and the nonlinear parts found at
  /// the earlier stages; 4: the end of the step. Real-time safe.
  Eigen::Vector2d stage(int index, const Eigen::Vector2d& start, const Eigen::Vector2d (&nonlinear)[4]) const;

  const Eigen::Matrix2d& linear() const { return linear_; }

 private:
  Eigen::Matrix2d linear_ = Eigen::Matrix2d::Zero();
  Eigen::Matrix2d half_ = Eigen::Matrix2d::Identity();    ///< e^(L h/2)
  Eigen::Matrix2d whole_ = Eigen::Matrix2d::Identity();   ///< e^(L h)
  Eigen::Matrix2d half_input_ = Eigen::Matrix2d::Zero();  ///< (h/2) phi_1(L h/2)
  Eigen::Matrix2d first_ = Eigen::Matrix2d::Zero();       ///< weights of the four nonlinear parts at the end
  Eigen::Matrix2d middle_ = Eigen::Matrix2d::Zero();
  Eigen::Matrix2d last_ = Eigen::Matrix2d::Zero();
};

}  // namespace handloop::sim
