#pragma once

#include "control/loop.h"

/// What keeps a wall from giving out energy, whoever holds the device: conditions on the device's own damping b and
/// friction that ask nothing of the operator but passivity. All take the wall as stated in control/loop.h, bilateral.
namespace handloop::control {

/// Colgate and Schenkel (J. Robotic Systems 14, 1997): the damping a device needs,
///     b > (T/2) max Re{(1 - e^{-jwT}) H(e^{jwT})}/(1 - cos wT) over 0 <= w <= pi/T,  H(z) = C(z) z^-d,
/// in N s/m. Exact for a rigid linear device, a hold and any passive operator; the delay enters through H. For K alone
/// it is K T (1/2 + d); for K and an unfiltered B without delay, K T/2 + |B|.
double colgate_required_damping(const LoopTiming& timing, const WallGains& gains);
/// Largest K that a device of damping b keeps passive with this B; negative where even K = 0 is not passive (NaN).
double colgate_permitted_stiffness(const LoopTiming& timing, double damping_Ns_per_m, double device_damping_Ns_per_m);

/// The linear rule K < (b + B)/(T/2 + d T) of Gil and others (JCISE 9, 2009), b being all physical damping, the hand's
/// included. Not a guarantee: an approximation for small b T/m and B T/m.
double gil_stiffness(const LoopTiming& timing, double damping_Ns_per_m, double physical_damping_Ns_per_m);

/// Abbott and Okamura (IEEE Trans. Robotics 21, 2005): with an encoder of resolution Delta and Coulomb friction f_c the
/// wall is passive where K <= min(2 b/T, 2 f_c/Delta), for B = 0. The delay form takes 2 b/((1 + 2 d) T) for the first.
struct AbbottOkamura {
  double by_damping = 0.0;   ///< N/m
  double by_friction = 0.0;  ///< N/m; infinity without quantisation
  double permitted() const { return by_damping < by_friction ? by_damping : by_friction; }
};
AbbottOkamura abbott_okamura(const LoopTiming& timing, double device_damping_Ns_per_m, double coulomb_N,
                             double resolution_m);

/// Diolaiti, Niemeyer, Barbagli and Salisbury (IEEE Trans. Robotics 22, 2006): the two energies of a wall, each with
/// what removes it. Sampling and delay need b >= K (T/2 + d T); quantisation needs c >= K Delta/2. A device may meet
/// one and not the other.
struct Diolaiti {
  double damping_ratio = 0.0;   ///< b/(K T); 1/2 + d removes sampling's energy
  double friction_ratio = 0.0;  ///< c/(K Delta); 1/2 removes quantisation's
  bool damping_suffices = false;
  bool friction_suffices = false;
};
Diolaiti diolaiti(const LoopTiming& timing, double stiffness_N_per_m, double device_damping_Ns_per_m, double coulomb_N,
                  double resolution_m);

/// Llewellyn's absolute stability of the haptic display as a two-port (Adams and Hannaford, IEEE Trans. Robotics and
/// Automation 15, 1999), the wall taken as the virtual coupling between the device and any passive virtual world: h11 =
/// m s + b, h12 = hold and delay, h21 = -1, h22 = 1/Z_wall with velocities by the trapezoidal rule. Stable with every
/// passive operator and world where
///     eta(w) = (2 Re h11 Re h22 - Re h12 h21)/|h12 h21| >= 1 for all w.
struct Llewellyn {
  double smallest_eta = 0.0;
  double at_rad_per_s = 0.0;
  bool absolutely_stable() const { return smallest_eta >= 1; }
};
Llewellyn llewellyn(const LoopTiming& timing, const WallGains& gains, double device_damping_Ns_per_m);
/// Largest K absolutely stable with this B, 0 where none is.
double llewellyn_permitted_stiffness(const LoopTiming& timing, double damping_Ns_per_m, double device_damping_Ns_per_m);

}  // namespace handloop::control
