#include <string>

#include "models/errors.h"
#include "models/phantom.h"

namespace handloop::models {
namespace {

Eigen::Matrix3d symmetric(double xx, double yy, double zz, double xy = 0, double xz = 0, double yz = 0) {
  Eigen::Matrix3d m;
  m << xx, xy, xz, xy, yy, yz, xz, yz, zz;
  return m;
}

/// Set B (Cavusoglu et al.). Printed with x along the joints 2 and 3, y vertical and z along the horizontal in the zero
/// pose; each tensor is turned into the link's own frame here. Those of `be` and `df` are about the joint axis: moved
/// to the centre of mass. The base has an inertia about the vertical only, and no mass.
PhantomParameters cavusoglu() {
  PhantomParameters p;
  p.l1_m = 0.215;
  p.l2_m = 0.170;
  p.l3_m = 0.0325;
  constexpr double l5 = -0.0368, l6 = 0.0527;
  constexpr double m_be = 0.2359, m_df = 0.1906;

  p.bodies[0].inertia_kg_m2 = symmetric(0, 0, 11.87e-4);

  // be, frame {2}: x along the link (their z), y up (their y), z along the joint (their x).
  auto& be = p.bodies[1];
  be.mass_kg = m_be;
  be.centre_of_mass_m = {l5, 0, 0};
  be.inertia_kg_m2 = symmetric(0.591e-4, 10.06e-4 - m_be * l5 * l5, 11.09e-4 - m_be * l5 * l5);

  // df, frame {3}: x down along the crank (their -y), y forward (their z), z along the joint.
  auto& df = p.bodies[2];
  df.mass_kg = m_df;
  df.centre_of_mass_m = {-l6, 0, 0};
  df.inertia_kg_m2 = symmetric(0.629e-4, 6.246e-4 - m_df * l6 * l6, 7.11e-4 - m_df * l6 * l6);

  // a, frame {2'}: x forward (their z), y up along the forearm (their y).
  auto& a = p.bodies[3];
  a.mass_kg = 0.0202;
  a.centre_of_mass_m = {0, -p.l2_m / 2, 0};
  a.inertia_kg_m2 = symmetric(0.4864e-4, 0.001843e-4, 0.4864e-4);

  // c, frame {3'}: x down (their -y), y forward along the coupler (their z).
  auto& c = p.bodies[4];
  c.mass_kg = 0.0249;
  c.centre_of_mass_m = {0, p.l1_m / 2, 0};
  c.inertia_kg_m2 = symmetric(0.959e-4, 0.0051e-4, 0.959e-4);
  return p;
}

/// Set A: mass properties of the CAD model, about the centres of mass. The program that printed them gives products of
/// inertia as +integral(xy dm): entries of the tensor have the other sign.
PhantomParameters cad() {
  PhantomParameters p;
  p.l1_m = 0.209550;
  p.l2_m = 0.169545;
  p.l3_m = 0.031750;
  p.gravity_m_per_s2 = 9.80665;
  p.bodies[0] = {0.36158943,
                 {-0.01048563, 0.01396387, -0.05380827},
                 symmetric(1.52017e-3, 1.21121e-3, 0.93887e-3, -5.838e-5, -1.8147e-4, -2.3832e-4)};
  p.bodies[1] = {0.26784227,
                 {-0.03518875, -0.0000628, 0.00232416},
                 symmetric(1.1330e-4, 9.1667e-4, 8.2222e-4, -4.1e-7, 2.296e-5, -4.8e-7)};
  p.bodies[2] = {0.21542122,
                 {-0.05153541, 0.00060903, 0.00402873},
                 symmetric(1.2140e-4, 2.6133e-4, 1.5823e-4, 3.2e-7, 7.45e-6, -3.23e-6)};
  p.bodies[3] = {0.02621969, {0.00002423, -0.05237892, 0}, symmetric(6.029e-5, 5.7e-7, 6.004e-5)};
  p.bodies[4] = {0.02614630, {0, 0.10477739, 0}, symmetric(1.3177e-4, 8.9e-7, 1.3138e-4)};
  return p;
}

}  // namespace

PhantomParameterSet parse_phantom_parameter_set(std::string_view text) {
  if (text == "cavusoglu") return PhantomParameterSet::cavusoglu;
  if (text == "cad") return PhantomParameterSet::cad;
  throw InputError("unknown parameter set '" + std::string(text) + "': give cavusoglu (nominal) or cad");
}

std::string_view phantom_parameter_set_name(PhantomParameterSet set) {
  return set == PhantomParameterSet::cavusoglu ? "cavusoglu" : "cad";
}

PhantomParameters phantom_parameters(PhantomParameterSet set, double tip_mass_kg) {
  PhantomParameters p = set == PhantomParameterSet::cavusoglu ? cavusoglu() : cad();
  p.tip_mass_kg = tip_mass_kg;
  return p;
}

}  // namespace handloop::models
