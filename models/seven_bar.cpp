#include "models/seven_bar.h"

#include <Eigen/Dense>
#include <cmath>
#include <numbers>

namespace handloop::models {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

/// A link of the scene: mass, inertia about its centre of mass, distance of that from the link's first pin.
struct Link {
  double mass_kg, inertia_kg_m2, centre_m;
};
constexpr Link kLink1{0.2248, 1.8733e-4, 0.05};
constexpr Link kLink2{0.3140, 1.0493e-3, 0.10};
constexpr Link kLink3{1.0889, 8.947e-3, 0.155};
constexpr Link kLink4{0.35325, 3.2087e-4, 0.05};
constexpr Link kLink5{0.48670, 3.9138e-3, 0.155};
constexpr Link kLink6{2.1075, 6.3664e-2, 0.20};
constexpr double kCrank_m = 0.10;  ///< links 1 and 4, and the short arms of 3 and 6

constexpr double about_pin(const Link& link) {
  return link.inertia_kg_m2 + link.mass_kg * link.centre_m * link.centre_m;
}

}  // namespace

SevenBarInertia seven_bar_inertia(const SevenBarParameters& d) {
  // Link 2 only moves along a circle with link 1's end; link 5 hangs on link 4's end and stays parallel to link 3.
  SevenBarInertia m;
  m.a_kg_m2 = about_pin(kLink1) + kLink2.mass_kg * kCrank_m * kCrank_m + about_pin(kLink3) + about_pin(kLink5) +
              (kLink6.mass_kg + d.load_kg) * d.upper_m * d.upper_m;
  m.b_kg_m2 = kLink6.mass_kg * d.upper_m * kLink6.centre_m - kLink5.mass_kg * kCrank_m * kLink5.centre_m +
              d.load_kg * d.upper_m * d.load_m;
  m.c_kg_m2 =
      about_pin(kLink4) + kLink5.mass_kg * kCrank_m * kCrank_m + about_pin(kLink6) + d.load_kg * d.load_m * d.load_m;
  m.g3_Nm = d.gravity_m_per_s2 *
            (kLink1.mass_kg * kLink1.centre_m + kLink2.mass_kg * kCrank_m + kLink3.mass_kg * kLink3.centre_m +
             kLink5.mass_kg * kLink5.centre_m + (kLink6.mass_kg + d.load_kg) * d.upper_m);
  m.g6_Nm = d.gravity_m_per_s2 * (kLink6.mass_kg * kLink6.centre_m - kLink4.mass_kg * kLink4.centre_m -
                                  kLink5.mass_kg * kCrank_m + d.load_kg * d.load_m);
  return m;
}

Vector2d seven_bar_point(const SevenBarParameters& d, const Vector2d& th, double reach_m) {
  return {d.upper_m * std::cos(th[0]) + reach_m * std::cos(th[1]),
          d.upper_m * std::sin(th[0]) + reach_m * std::sin(th[1])};
}

Vector2d seven_bar_handle(const SevenBarParameters& d, const Vector2d& th) {
  return seven_bar_point(d, th, d.handle_m);
}

Matrix2d seven_bar_jacobian(const SevenBarParameters& d, const Vector2d& th, double reach_m) {
  Matrix2d j;
  j << -d.upper_m * std::sin(th[0]), -reach_m * std::sin(th[1]),  //
      d.upper_m * std::cos(th[0]), reach_m * std::cos(th[1]);
  return j;
}

Vector2d seven_bar_bias_acceleration(const SevenBarParameters& d, const Vector2d& th, const Vector2d& rate) {
  const Vector2d square = rate.cwiseAbs2();
  return {-d.upper_m * std::cos(th[0]) * square[0] - d.handle_m * std::cos(th[1]) * square[1],
          -d.upper_m * std::sin(th[0]) * square[0] - d.handle_m * std::sin(th[1]) * square[1]};
}

Matrix2d seven_bar_mass_matrix(const SevenBarInertia& m, const Vector2d& th) {
  const double coupling = m.b_kg_m2 * std::cos(th[0] - th[1]);
  Matrix2d mass;
  mass << m.a_kg_m2, coupling, coupling, m.c_kg_m2;
  return mass;
}

Vector2d seven_bar_coriolis(const SevenBarInertia& m, const Vector2d& th, const Vector2d& rate) {
  const double k = m.b_kg_m2 * std::sin(th[0] - th[1]);
  return {k * rate[1] * rate[1], -k * rate[0] * rate[0]};
}

Vector2d seven_bar_gravity(const SevenBarInertia& m, const Vector2d& th) {
  return {m.g3_Nm * std::cos(th[0]), m.g6_Nm * std::cos(th[1])};
}

Matrix2d seven_bar_handle_mass(const SevenBarParameters& d, const SevenBarInertia& inertia, const Vector2d& th) {
  const Matrix2d back = seven_bar_jacobian(d, th, d.handle_m).inverse();
  return back.transpose() * seven_bar_mass_matrix(inertia, th) * back;
}

Matrix2d seven_bar_load_to_handle(const SevenBarParameters& d, const Vector2d& th) {
  return seven_bar_jacobian(d, th, d.handle_m).inverse().transpose() * seven_bar_jacobian(d, th, d.load_m).transpose();
}

Matrix2d seven_bar_environment_mass(const SevenBarParameters& d, const Vector2d& th) {
  const Matrix2d to_handle = seven_bar_load_to_handle(d, th);
  return d.load_kg * to_handle * to_handle.transpose();
}

Vector2d seven_bar_home() {
  return {-std::numbers::pi / 2, 0.0};
}

}  // namespace handloop::models
