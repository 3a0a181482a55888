#pragma once

#include "control/controllers/controller.h"
#include "models/scenario.h"

namespace handloop::control {

/// What may be turned while the loop runs.
struct VirtualWallGains {
  double stiffness_N_per_m = 400.0;
  double damping_Ns_per_m = 1.0;
  double cutoff_Hz = 100.0;
};

/// A virtual wall: a spring and a filtered damper against penetration along one axis,
///     F(z) = -(K + B (1 - a)/T (z - 1)/(z - a)) p(z),   a = exp(-2 pi f_c T),
/// the C(z) the margins are computed for (negative feedback), with p the penetration: positive beyond `plane_m` in the
/// direction of the axis. A one-sided wall acts only where p > 0 and never pulls; a bilateral one is linear everywhere.
/// Gravity compensation feeds forward what the mechanism needs to hold itself. The delay of the loop is not in here.
class VirtualWall final : public Controller {
 public:
  struct Settings {
    int row = 0;           ///< device-frame row of the axis: 0 x, 1 y, 2 z
    double plane_m = 0.0;  ///< absolute, device frame
    bool bilateral = false;
    bool gravity_compensation = true;
    double sample_time_s = 0.001;
    VirtualWallGains gains;
  };

  /// Throws InputError where a setting is not possible (not finite, negative, cut-off or sample time not positive).
  explicit VirtualWall(const Settings& settings);

  void reset() noexcept override;
  ControllerOutput step(const ControllerInput& input) noexcept override;

  /// Takes effect at the next sample; real-time safe. The filter's state is a position, so new gains make no velocity
  /// step. Gains that are not finite or are negative are ignored and false returned.
  bool set_gains(const VirtualWallGains& gains) noexcept;
  const VirtualWallGains& gains() const noexcept { return settings_.gains; }

 private:
  Settings settings_;
  double pole_ = 0.0;  ///< a
  bool started_ = false;
  double last_p_m_ = 0.0;
  double velocity_m_per_s_ = 0.0;  ///< (1 - a)/T (z - 1)/(z - a) p
};

/// The wall a scenario asks for, about the tip at the scenario's pose (absolute, device frame, m).
VirtualWall make_virtual_wall(const models::Scenario& scenario, const Eigen::Vector3d& tip_at_pose_m);

}  // namespace handloop::control
