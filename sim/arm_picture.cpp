#include "sim/arm_picture.h"

#include <mujoco/mujoco.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace handloop::sim {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

/// As drawn in scenes/phantom.xml.
const Vector3d kWrist{0.160, 0.004, 0.019};
constexpr double kLowerArm_m = 0.235;
constexpr double kUpperArm_m = 0.280;
/// Shoulder of the person's right arm, from the tip at the pose: the person sits opposite.
const Vector3d kShoulder{0.46, 0.10, 0.26};

void set_mocap(mjData* data, int index, const Vector3d& position, const Quaterniond& q) {
  Eigen::Map<Vector3d>(data->mocap_pos + 3 * index) = position;
  data->mocap_quat[4 * index] = q.w();
  data->mocap_quat[4 * index + 1] = q.x();
  data->mocap_quat[4 * index + 2] = q.y();
  data->mocap_quat[4 * index + 3] = q.z();
}

/// From `far` towards `near` along the body's x.
void set_segment(mjData* data, int index, const Vector3d& far, const Vector3d& near) {
  set_mocap(data, index, far, Quaterniond::FromTwoVectors(Vector3d::UnitX(), near - far));
}

}  // namespace

void pose_picture(const PhantomScene& scene, const Vector3d& tip_at_pose_m, const PlantTruth& truth,
                  const models::WallSettings& wall, mjData* data) {
  Vector3d tip = tip_at_pose_m;
  for (const auto axis : models::kAxes) tip[models::device_row(axis)] += truth.tip_m[static_cast<std::size_t>(axis)];
  set_mocap(data, scene.hand_mocap, tip, Quaterniond::Identity());
  const Vector3d wrist = tip + kWrist, shoulder = tip_at_pose_m + kShoulder;
  // elbow: on the circle both bones reach, at its lowest
  const Vector3d line = wrist - shoulder;
  const double reach = std::clamp(line.norm(), std::abs(kUpperArm_m - kLowerArm_m), kUpperArm_m + kLowerArm_m);
  const Vector3d along = line.normalized();
  const double foot = (kUpperArm_m * kUpperArm_m - kLowerArm_m * kLowerArm_m + reach * reach) / (2 * reach);
  const double height = std::sqrt(std::max(kUpperArm_m * kUpperArm_m - foot * foot, 0.0));
  const Vector3d outward = Vector3d(0.25, 0.35, -1.0);
  const Vector3d down = (outward - outward.dot(along) * along).normalized();
  const Vector3d elbow = shoulder + foot * along + height * down;
  set_segment(data, scene.lower_arm_mocap, elbow, wrist);
  set_segment(data, scene.upper_arm_mocap, shoulder, elbow);
  Vector3d normal = Vector3d::Zero();
  normal[models::device_row(wall.axis)] = 1.0;
  set_mocap(data, scene.wall_mocap, tip_at_pose_m + wall.position_m * normal,
            Quaterniond::FromTwoVectors(Vector3d::UnitX(), normal));
  mj_kinematics(scene.model.get(), data);
  mj_comPos(scene.model.get(), data);
  mj_camlight(scene.model.get(), data);
}

}  // namespace handloop::sim
