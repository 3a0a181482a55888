#pragma once

#include <Eigen/Core>
#include <array>
#include <string_view>

#include "models/axis.h"

/// Phantom Premium 1.5 in closed form: kinematics, Jacobian, mass matrix, gravity and the inertia felt at the tip.
///
/// Device frame {0}: origin on the base axis at the height of the shoulder, x fore-aft (away from the base), y lateral,
/// z up. Joint angles q = (q1, q2, q3) in rad: q1 turns the base about z; q2 lifts the upper link from the horizontal;
/// q3 swings the forearm forward from hanging vertically. q2 and q3 are absolute: each motor sets one of them through
/// the parallelogram, and q = (0, 0, 0) is the home pose with the tip at (l1, 0, -l2). Joint torques tau act on q;
/// motor torques are models/transducers.h.
///
/// All functions work on fixed-size values: no allocation, no throw, real-time safe, unless they say otherwise.
namespace handloop::models {

enum class PhantomParameterSet {
  cavusoglu,  ///< set B, nominal: Cavusoglu et al. (UCB/ERL M01/15, 2001), as transcribed in github.com/mahilab/Phantom
  cad         ///< set A: mass properties of a CAD model (same repository); 5 to 13 % from set B
};

/// "cavusoglu" or "cad". Throws InputError for anything else.
PhantomParameterSet parse_phantom_parameter_set(std::string_view text);
std::string_view phantom_parameter_set_name(PhantomParameterSet set);

/// Moving bodies. Each turns with one angle of the pose; frames as in the CAD source.
enum class PhantomLink {
  base,     ///< g: turns with q1
  upper,    ///< be: link l1 and its motor, frame {2} = Rz(q1) Rx(90 deg) Rz(q2) at the shoulder
  crank,    ///< df: parallelogram crank l3 and its motor, frame {3} = .. Rz(q3 - 90 deg) at the shoulder
  forearm,  ///< a: link l2, frame {2'} = .. Rz(q3) at the elbow
  coupler   ///< c: parallel to l1, frame {3'} = .. Rz(q2 - 90 deg) at the end of the crank
};

struct PhantomBody {
  double mass_kg = 0.0;
  Eigen::Vector3d centre_of_mass_m = Eigen::Vector3d::Zero();  ///< in the link's frame
  Eigen::Matrix3d inertia_kg_m2 = Eigen::Matrix3d::Zero();     ///< about the centre of mass, along the link's frame
};

struct PhantomParameters {
  double l1_m = 0.0;                  ///< upper link, shoulder to elbow
  double l2_m = 0.0;                  ///< forearm, elbow to tip
  double l3_m = 0.0;                  ///< crank of the parallelogram
  std::array<PhantomBody, 5> bodies;  ///< in the order of PhantomLink
  double tip_mass_kg = 0.0;           ///< stylus, gimbal and force sensor as a point at the tip; in neither set
  /// Added to the mass matrix as ratio^2 times this; neither set says whether its link masses hold the rotors already.
  double rotor_inertia_kg_m2 = 0.0;
  double gravity_m_per_s2 = 9.81;

  const PhantomBody& body(PhantomLink link) const { return bodies[static_cast<std::size_t>(link)]; }
};

/// The published set, with a point mass at the tip: 52 g of stylus and gimbal in the arm paper's rig, 0 for the bare
/// device.
PhantomParameters phantom_parameters(PhantomParameterSet set, double tip_mass_kg = 0.0);

/// Position of the tip in the device frame, m.
Eigen::Vector3d phantom_tip(const PhantomParameters& device, const Eigen::Vector3d& q_rad);

/// dp/dq in m/rad, 3 x 3: p' = J q', tau = J^T F.
Eigen::Matrix3d phantom_jacobian(const PhantomParameters& device, const Eigen::Vector3d& q_rad);

/// Angles that put the tip at a point, elbow up. Throws InputError where the point is out of reach.
Eigen::Vector3d phantom_inverse(const PhantomParameters& device, const Eigen::Vector3d& tip_m);

/// Joint-space mass matrix M(q), kg m^2, tip mass and rotors included: tau = M q'' + C q' + N.
Eigen::Matrix3d phantom_mass_matrix(const PhantomParameters& device, const Eigen::Vector3d& q_rad);

/// Torques N(q) in Nm that hold the device still against gravity, tip mass included.
Eigen::Vector3d phantom_gravity(const PhantomParameters& device, const Eigen::Vector3d& q_rad);

/// Coriolis and centrifugal torques C(q, q') q' in Nm (Christoffel symbols of M).
Eigen::Vector3d phantom_coriolis(const PhantomParameters& device, const Eigen::Vector3d& q_rad,
                                 const Eigen::Vector3d& q_rate_rad_per_s);

/// Joint limits of the device, rad: q1, q2, q3 and the difference q3 - q2 (the parallelogram's own limit).
struct PhantomLimits {
  std::array<double, 3> lower_rad, upper_rad;
  double lower_difference_rad, upper_difference_rad;
};
PhantomLimits phantom_limits();
bool within_limits(const Eigen::Vector3d& q_rad);

/// Inverse of the inertia at the tip, 1/kg, 3 x 3 in the device frame: J M^-1 J^T. A force F at the tip of the device
/// at rest accelerates it by this times F. Finite in singular poses too.
Eigen::Matrix3d phantom_tip_mobility(const PhantomParameters& device, const Eigen::Vector3d& q_rad);

/// Mass in kg that a force along one axis of the hand moves at the tip, the other axes free: 1 / (J M^-1 J^T)_ii.
/// At the home pose, where the axes are uncoupled, also the mass with the others held.
double phantom_tip_inertia_kg(const PhantomParameters& device, const Eigen::Vector3d& q_rad, Axis axis);

}  // namespace handloop::models
