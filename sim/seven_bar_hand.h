#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "models/scenario.h"

namespace handloop::sim {

/// The arm at the seven-bar's handle in time: what its muscles, tissue and neural feedback do. Its mass is a body of
/// the scene; this is the force on that body. x forward, y up, positions from where the handle was at the pose.
/// Real-time safe after construction.
class SevenBarHandModel {
 public:
  SevenBarHandModel(const models::Scenario& scenario, double step_s);
  void reset() noexcept;

  /// Muscle force of the scenario: lines of equal size and random phase up to the bandwidth, after a second's swell.
  Eigen::Vector2d irregular_force_N(double t_s) const noexcept;

  /// One step of activation and feedback: `contact_N` is f_h of the step before, `muscle_N` the command m (u_h where
  /// there is no feedback). Returns the force on the arm's mass, N.
  Eigen::Vector2d step(const Eigen::Vector2d& muscle_N, const Eigen::Vector2d& contact_N,
                       const Eigen::Vector2d& position_m, const Eigen::Vector2d& velocity_m_per_s) noexcept;
  const Eigen::Vector2d& intended_N() const noexcept { return intended_N_; }
  double mass_kg() const noexcept { return arm_.mass_kg; }

 private:
  models::NeuralArm arm_;
  double cubic_N_per_m3_, step_s_;
  bool neural_;
  struct Line {
    double frequency_rad_per_s, amplitude_N, phase_x, phase_y;
  };
  std::vector<Line> lines_;
  std::vector<Eigen::Vector2d> past_;  ///< contact forces, a ring as long as the neural delay
  std::size_t newest_ = 0;
  Eigen::Vector2d feedback_N_ = Eigen::Vector2d::Zero();  ///< behind G_f
  Eigen::Vector2d intended_N_ = Eigen::Vector2d::Zero();  ///< behind G_a
};

}  // namespace handloop::sim
