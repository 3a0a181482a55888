#pragma once

#include <Eigen/Core>

#include "models/scenario.h"
#include "sim/phantom_plant.h"
#include "sim/phantom_scene.h"

namespace handloop::sim {

/// Poses what is only drawn: the hand at the grip, a right arm between it and a shoulder that rests (elbow hanging
/// down), and the wall. Then places all shapes (mj_kinematics). Real-time safe; the physics is not touched.
void pose_picture(const PhantomScene& scene, const Eigen::Vector3d& tip_at_pose_m, const PlantTruth& truth,
                  const models::WallSettings& wall, mjData_* data);

}  // namespace handloop::sim
