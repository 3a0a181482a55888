#pragma once

#include <Eigen/Core>
#include <array>

#include "control/controllers/controller.h"
#include "control/transfer_matrix.h"
#include "models/scenario.h"
#include "models/seven_bar.h"

namespace handloop::control {

/// The controller of Kazerooni and Her's interface.
///
/// Force control: p_des = K (alpha f_h + f_e), both forces measured.
/// Primary stabilising controller: the desired position passes through G(s) of (17) and the device follows that
/// reference by computed torque and a stiff PD loop,
///     tau = M J^-1 (a_ref + k_d (v_ref - v) + k_p (p_ref - p) - J' th') + C + g - J^T f_h,
/// with k_p = w^2, k_d = 2 w. The computed torque carries the known load and the measured hand force, which is what
/// makes S_h small. Velocities are filtered differences.
///
/// The hand is lost when the grip on the handle is gone: the device then stays where it was let go, and takes up the
/// hand again from there without a jump.
///
/// Everything is built before: step() is real-time safe.
class ForceAmplifier final : public Controller {
 public:
  static constexpr double kVelocityCutoff_Hz = 200.0;
  static constexpr double kGripLost_N = 2.0;

  struct Settings {
    models::SevenBarParameters device;
    models::PrimaryLoop primary;
    TransferFunction K;
    TransferMatrix alpha;
    Eigen::Vector2d home_rad = models::seven_bar_home();  ///< where p = 0
    double bandwidth_rad_per_s = 200.0;                   ///< w
    double sample_time_s = 2e-4;
  };

  /// Throws InputError where K alpha cannot run in time (more zeros than poles, unstable) or a number is impossible.
  explicit ForceAmplifier(const Settings& settings);

  void reset() noexcept override;
  ControllerOutput step(const ControllerInput& input) noexcept override;

  /// Added to p_des, m: to measure G.
  void disturb(const Eigen::Vector2d& desired_m) noexcept { extra_m_ = desired_m; }
  const Eigen::Vector2d& desired_m() const noexcept { return desired_m_; }      ///< p_des, from home; x forward, y up
  const Eigen::Vector2d& reference_m() const noexcept { return reference_m_; }  ///< behind G
  const Eigen::Vector2d& position_m() const noexcept { return position_m_; }
  bool holding() const noexcept { return holding_; }  ///< the hand is lost

 private:
  void follow_forces(const ControllerInput& input) noexcept;
  void hold() noexcept;
  void watch_grip(double grip_N) noexcept;

  Settings settings_;
  models::SevenBarInertia inertia_;
  Eigen::Vector2d origin_m_;
  double velocity_pole_;
  std::array<std::array<DiscreteFilter, 2>, 2> hand_filter_;  ///< K alpha
  std::array<DiscreteFilter, 2> environment_filter_;          ///< K
  Eigen::Matrix3d advance_;                                   ///< of the states of G: q, q', q'' of q = p_ref's source
  Eigen::Vector3d take_;

  Eigen::Matrix<double, 3, 2> states_ = Eigen::Matrix<double, 3, 2>::Zero();
  Eigen::Vector2d last_desired_m_ = Eigen::Vector2d::Zero();
  Eigen::Vector2d offset_m_ = Eigen::Vector2d::Zero();  ///< where the hand last took hold
  Eigen::Vector2d hold_m_ = Eigen::Vector2d::Zero();
  Eigen::Vector2d extra_m_ = Eigen::Vector2d::Zero();
  Eigen::Vector2d desired_m_ = Eigen::Vector2d::Zero(), reference_m_ = Eigen::Vector2d::Zero();
  Eigen::Vector2d reference_m_per_s_ = Eigen::Vector2d::Zero(), reference_m_per_s2_ = Eigen::Vector2d::Zero();
  Eigen::Vector2d position_m_ = Eigen::Vector2d::Zero();
  Eigen::Vector2d error_m_ = Eigen::Vector2d::Zero(), error_rate_m_per_s_ = Eigen::Vector2d::Zero();
  Eigen::Vector2d joint_rad_ = Eigen::Vector2d::Zero(), rate_rad_per_s_ = Eigen::Vector2d::Zero();
  bool started_ = false, holding_ = false;
  int grip_samples_ = 0;
};

/// The controller a scenario asks for. Throws InputError naming the key.
ForceAmplifier make_force_amplifier(const models::Scenario& scenario);
/// K and alpha of a scenario.
TransferFunction filter_of(const models::ForceAmplifierSettings& settings);
TransferMatrix alpha_of(const models::ForceAmplifierSettings& settings);

}  // namespace handloop::control
