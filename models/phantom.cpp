#include "models/phantom.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "models/errors.h"
#include "models/transducers.h"

namespace handloop::models {
namespace {

constexpr double kQuarterTurn = std::numbers::pi / 2;

/// Where a body is and how it moves: rotation of its frame, position of its centre of mass, and their derivatives by q.
struct BodyMotion {
  Eigen::Matrix3d rotation;
  Eigen::Vector3d centre_of_mass;
  Eigen::Matrix3d linear_jacobian;   ///< of the centre of mass, m/rad
  Eigen::Matrix3d angular_jacobian;  ///< rad/rad, device frame
};

/// Unit vectors of the vertical plane that turns with the base: forward, and the normal about which q2 and q3 turn.
struct Plane {
  Eigen::Vector3d forward, normal;
  explicit Plane(double q1) : forward(std::cos(q1), std::sin(q1), 0), normal(std::sin(q1), -std::cos(q1), 0) {}
  /// Rotation of a frame that has turned by an angle within the plane: Rz(q1) Rx(90 deg) Rz(angle).
  Eigen::Matrix3d frame(double angle) const {
    Eigen::Matrix3d r;
    r.col(0) = std::cos(angle) * forward + std::sin(angle) * Eigen::Vector3d::UnitZ();
    r.col(1) = -std::sin(angle) * forward + std::cos(angle) * Eigen::Vector3d::UnitZ();
    r.col(2) = normal;
    return r;
  }
};

/// A body whose own angle is q[own] + offset and whose frame's origin is carried by an arm of the given length that
/// turns with q[carrier] + carrier_offset.
BodyMotion planar_body(const Plane& plane, const Eigen::Vector3d& q, const PhantomBody& body, int own, double offset,
                       double arm_m, int carrier, double carrier_offset) {
  BodyMotion motion;
  motion.rotation = plane.frame(q[own] + offset);
  const Eigen::Matrix3d arm_frame = plane.frame(q[carrier] + carrier_offset);
  const Eigen::Vector3d origin = arm_m * arm_frame.col(0);
  const Eigen::Vector3d from_origin = motion.rotation * body.centre_of_mass_m;
  motion.centre_of_mass = origin + from_origin;
  motion.linear_jacobian.setZero();
  motion.linear_jacobian.col(0) = Eigen::Vector3d::UnitZ().cross(motion.centre_of_mass);
  motion.linear_jacobian.col(own) += plane.normal.cross(from_origin);
  motion.linear_jacobian.col(carrier) += plane.normal.cross(origin);
  motion.angular_jacobian.setZero();
  motion.angular_jacobian.col(0) = Eigen::Vector3d::UnitZ();
  motion.angular_jacobian.col(own) = plane.normal;
  return motion;
}

std::array<BodyMotion, 5> body_motions(const PhantomParameters& device, const Eigen::Vector3d& q) {
  const Plane plane(q[0]);
  std::array<BodyMotion, 5> motions;
  auto& base = motions[0];
  base.rotation << std::cos(q[0]), -std::sin(q[0]), 0, std::sin(q[0]), std::cos(q[0]), 0, 0, 0, 1;
  base.centre_of_mass = base.rotation * device.body(PhantomLink::base).centre_of_mass_m;
  base.linear_jacobian.setZero();
  base.linear_jacobian.col(0) = Eigen::Vector3d::UnitZ().cross(base.centre_of_mass);
  base.angular_jacobian.setZero();
  base.angular_jacobian.col(0) = Eigen::Vector3d::UnitZ();
  motions[1] = planar_body(plane, q, device.body(PhantomLink::upper), 1, 0, 0, 1, 0);
  motions[2] = planar_body(plane, q, device.body(PhantomLink::crank), 2, -kQuarterTurn, 0, 2, 0);
  motions[3] = planar_body(plane, q, device.body(PhantomLink::forearm), 2, 0, device.l1_m, 1, 0);
  motions[4] =
      planar_body(plane, q, device.body(PhantomLink::coupler), 1, -kQuarterTurn, device.l3_m, 2, -kQuarterTurn);
  return motions;
}

/// dM/dq_k, kg m^2/rad. M is a trigonometric polynomial of degree two in each angle, so its derivative follows exactly
/// from its values a quarter and an eighth of a turn away.
Eigen::Matrix3d mass_matrix_derivative(const PhantomParameters& device, const Eigen::Vector3d& q, int k) {
  const auto difference = [&](double step) -> Eigen::Matrix3d {
    Eigen::Vector3d ahead = q, behind = q;
    ahead[k] += step;
    behind[k] -= step;
    return phantom_mass_matrix(device, ahead) - phantom_mass_matrix(device, behind);
  };
  return difference(kQuarterTurn / 2) + 0.5 * (1 - std::numbers::sqrt2) * difference(kQuarterTurn);
}

}  // namespace

Eigen::Vector3d phantom_tip(const PhantomParameters& device, const Eigen::Vector3d& q) {
  const double r = device.l1_m * std::cos(q[1]) + device.l2_m * std::sin(q[2]);
  return {std::cos(q[0]) * r, std::sin(q[0]) * r, device.l1_m * std::sin(q[1]) - device.l2_m * std::cos(q[2])};
}

Eigen::Matrix3d phantom_jacobian(const PhantomParameters& device, const Eigen::Vector3d& q) {
  const double c1 = std::cos(q[0]), s1 = std::sin(q[0]);
  const double c2 = device.l1_m * std::cos(q[1]), s2 = device.l1_m * std::sin(q[1]);
  const double c3 = device.l2_m * std::cos(q[2]), s3 = device.l2_m * std::sin(q[2]);
  const double r = c2 + s3;
  Eigen::Matrix3d j;
  j << -s1 * r, -c1 * s2, c1 * c3,  //
      c1 * r, -s1 * s2, s1 * c3,    //
      0, c2, s3;
  return j;
}

Eigen::Vector3d phantom_inverse(const PhantomParameters& device, const Eigen::Vector3d& tip) {
  const double l1 = device.l1_m, l2 = device.l2_m;
  const double radius = std::hypot(tip[0], tip[1]);
  const double distance = std::hypot(radius, tip[2]);
  if (!(distance <= l1 + l2) || distance < std::abs(l1 - l2) || distance == 0) {
    throw InputError("the tip cannot reach (" + std::to_string(tip[0]) + ", " + std::to_string(tip[1]) + ", " +
                     std::to_string(tip[2]) + ") m: it must be " + std::to_string(std::abs(l1 - l2)) + " to " +
                     std::to_string(l1 + l2) + " m from the shoulder");
  }
  const auto angle_between = [](double opposite, double a, double b) {
    return std::acos(std::clamp((a * a + b * b - opposite * opposite) / (2 * a * b), -1.0, 1.0));
  };
  const double q2 = std::atan2(tip[2], radius) + angle_between(l2, l1, distance);
  const double q3 = q2 + angle_between(distance, l1, l2) - kQuarterTurn;
  return {std::atan2(tip[1], tip[0]), q2, q3};
}

Eigen::Matrix3d phantom_mass_matrix(const PhantomParameters& device, const Eigen::Vector3d& q) {
  const auto motions = body_motions(device, q);
  Eigen::Matrix3d m = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < motions.size(); ++i) {
    const auto& motion = motions[i];
    const auto& body = device.bodies[i];
    const Eigen::Matrix3d turned = motion.rotation.transpose() * motion.angular_jacobian;
    m += body.mass_kg * motion.linear_jacobian.transpose() * motion.linear_jacobian +
         turned.transpose() * body.inertia_kg_m2 * turned;
  }
  if (device.tip_mass_kg > 0) {
    const Eigen::Matrix3d j = phantom_jacobian(device, q);
    m += device.tip_mass_kg * j.transpose() * j;
  }
  constexpr auto ratio = phantom_drive().ratio;
  for (int i = 0; i < 3; ++i) {
    m(i, i) += ratio[static_cast<std::size_t>(i)] * ratio[static_cast<std::size_t>(i)] * device.rotor_inertia_kg_m2;
  }
  return m;
}

Eigen::Vector3d phantom_gravity(const PhantomParameters& device, const Eigen::Vector3d& q) {
  const auto motions = body_motions(device, q);
  Eigen::Vector3d torque = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < motions.size(); ++i) {
    torque += device.bodies[i].mass_kg * motions[i].linear_jacobian.row(2).transpose();
  }
  torque += device.tip_mass_kg * phantom_jacobian(device, q).row(2).transpose();
  return device.gravity_m_per_s2 * torque;
}

Eigen::Vector3d phantom_coriolis(const PhantomParameters& device, const Eigen::Vector3d& q,
                                 const Eigen::Vector3d& rate) {
  // C q' = M' q' - 1/2 d/dq (q'^T M q'); M does not depend on q1.
  Eigen::Vector3d torque = Eigen::Vector3d::Zero();
  for (int k = 1; k < 3; ++k) {
    const Eigen::Matrix3d derivative = mass_matrix_derivative(device, q, k);
    torque += rate[k] * derivative * rate;
    torque[k] -= 0.5 * rate.dot(derivative * rate);
  }
  return torque;
}

PhantomLimits phantom_limits() {
  constexpr double degree = std::numbers::pi / 180;
  return {{-90 * degree, -124 * degree, -29 * degree},
          {90 * degree, 119 * degree, 214 * degree},
          -65 * degree,
          55 * degree};
}

bool within_limits(const Eigen::Vector3d& q) {
  const auto limits = phantom_limits();
  for (int i = 0; i < 3; ++i) {
    const auto n = static_cast<std::size_t>(i);
    if (!(q[i] >= limits.lower_rad[n] && q[i] <= limits.upper_rad[n])) return false;
  }
  const double difference = q[2] - q[1];
  return difference >= limits.lower_difference_rad && difference <= limits.upper_difference_rad;
}

Eigen::Matrix3d phantom_tip_mobility(const PhantomParameters& device, const Eigen::Vector3d& q) {
  const Eigen::Matrix3d j = phantom_jacobian(device, q);
  return j * phantom_mass_matrix(device, q).inverse() * j.transpose();
}

double phantom_tip_inertia_kg(const PhantomParameters& device, const Eigen::Vector3d& q, Axis axis) {
  const int row = device_row(axis);
  return 1.0 / phantom_tip_mobility(device, q)(row, row);
}

}  // namespace handloop::models
