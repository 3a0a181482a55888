#pragma once

#include <Eigen/Core>
#include <array>
#include <complex>

/// The force-amplifying linkage of Kazerooni and Her ("The dynamics and control of a haptic interface device", IEEE
/// Trans. Robotics and Automation 10(4), 1994) in closed form, and the transfer functions they print.
///
/// Frame: a vertical plane, x forward and y up as in their Fig. 7, origin on the shoulder axis. Angles
/// th = (th3, th6) in rad are absolute, from +x towards +y; both four-bars are parallelograms, so motor 1 turns link 3
/// and motor 2 link 6 by its own angle. The handle is where p is measured; f_h and f_e are forces on the device.
///
/// ASSUMPTION OF OURS: every length but the handle's 0.3 m and the load's 0.5 m, and with them every mass: the paper
/// prints none and no drawing was found. Material of the links, handle, load and layout are the paper's.
///
/// Fixed-size values only: no allocation, no throw, real-time safe.
namespace handloop::models {

/// M = [[a, b cos(th3 - th6)], [., c]] in kg m^2, gravity torque (g3 cos th3, g6 cos th6) in Nm.
struct SevenBarInertia {
  double a_kg_m2 = 0.0, b_kg_m2 = 0.0, c_kg_m2 = 0.0;
  double g3_Nm = 0.0, g6_Nm = 0.0;
};

struct SevenBarParameters {
  double upper_m = 0.31;   ///< link 3, shoulder to elbow; ours
  double handle_m = 0.30;  ///< elbow to handle; the paper's
  double load_m = 0.50;    ///< elbow to load; the paper's
  double load_kg = 33.82 / 9.80665;
  double gravity_m_per_s2 = 9.80665;
};

/// Stops, rad, as in scenes/seven_bar.xml; ours. The limit switches stand this far inside.
struct SevenBarStops {
  std::array<double, 2> lower_rad{-2.75, -1.25}, upper_rad{-0.35, 1.25};
  double elbow_lower_rad = 0.3047, elbow_upper_rad = 2.8369;  ///< th6 - th3
  double switch_inside_rad = 0.05;
};

/// Of the six moving links and the load, from the sections and materials of the scene.
SevenBarInertia seven_bar_inertia(const SevenBarParameters& device);

/// Point on link 6 at `reach_m` from the elbow, m.
Eigen::Vector2d seven_bar_point(const SevenBarParameters& device, const Eigen::Vector2d& th_rad, double reach_m);
Eigen::Vector2d seven_bar_handle(const SevenBarParameters& device, const Eigen::Vector2d& th_rad);
/// d point / d th, m/rad.
Eigen::Matrix2d seven_bar_jacobian(const SevenBarParameters& device, const Eigen::Vector2d& th_rad, double reach_m);
/// J' th' of the handle, m/s^2: its acceleration while th'' = 0.
Eigen::Vector2d seven_bar_bias_acceleration(const SevenBarParameters& device, const Eigen::Vector2d& th_rad,
                                            const Eigen::Vector2d& rate_rad_per_s);
Eigen::Matrix2d seven_bar_mass_matrix(const SevenBarInertia& inertia, const Eigen::Vector2d& th_rad);
/// Coriolis and centrifugal torques, Nm.
Eigen::Vector2d seven_bar_coriolis(const SevenBarInertia& inertia, const Eigen::Vector2d& th_rad,
                                   const Eigen::Vector2d& rate_rad_per_s);
/// Torques that hold the device and its load still, Nm.
Eigen::Vector2d seven_bar_gravity(const SevenBarInertia& inertia, const Eigen::Vector2d& th_rad);
/// Mass at the handle, kg, 2 x 2: (J M^-1 J^T)^-1.
Eigen::Matrix2d seven_bar_handle_mass(const SevenBarParameters& device, const SevenBarInertia& inertia,
                                      const Eigen::Vector2d& th_rad);
/// What a force at the load is at the handle: f_e = J_handle^-T J_load^T f (equal virtual work). Singular where the arm
/// is stretched or folded.
Eigen::Matrix2d seven_bar_load_to_handle(const SevenBarParameters& device, const Eigen::Vector2d& th_rad);
/// The load's mass as the handle feels it, kg, 2 x 2: E = this times s^2. In y about the elbow it is (0.5/0.3)^2 of the
/// load: 9.58 kg, where (19) prints 9.08 (20.0 lb).
Eigen::Matrix2d seven_bar_environment_mass(const SevenBarParameters& device, const Eigen::Vector2d& th_rad);

/// Where a scenario begins and margins are taken unless it says otherwise: upper arm down, forearm level.
Eigen::Vector2d seven_bar_home();

/// G(s) of (17) = (n1 s + n0)/(d3 s^3 + s^2 + d1 s + d0), position over desired position. The printed unit
/// "Newton/Newton" must be a slip: both are lengths.
struct PrimaryLoop {
  double n1 = 1.2516, n0 = 2.079, d3 = 0.002, d1 = 1.2516, d0 = 2.079;
  std::complex<double> operator()(std::complex<double> s) const {
    return (n1 * s + n0) / (((d3 * s + 1.0) * s + d1) * s + d0);
  }
};

/// H_0 of (18), 12.1 (s^2/43.69 + s/5.08 + 1) lbf/ft, in SI: 4.0418 s^2 + 34.761 s + 176.586 N/m.
struct HandImpedance {
  double mass_kg = 4.0418, damping_Ns_per_m = 34.76107, stiffness_N_per_m = 176.5862;
  std::complex<double> operator()(std::complex<double> s) const {
    return (mass_kg * s + damping_Ns_per_m) * s + stiffness_N_per_m;
  }
};

/// E_0 of (19), kg: 9.08 s^2 N/m.
inline constexpr double kPrintedEnvironmentMass_kg = 9.08;

}  // namespace handloop::models
