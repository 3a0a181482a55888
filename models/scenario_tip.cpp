#include "models/scenario_tip.h"

#include <Eigen/Dense>
#include <cmath>

#include "models/errors.h"

namespace handloop::models {

ScenarioTip tip_of(const Scenario& scenario, Axis axis) {
  const auto& device = scenario.device;
  if (device.model != DeviceModel::phantom_premium_1_5) {
    throw InputError("scenario '" + scenario.name +
                     "': the inertia at the tip is known in closed form for the device " +
                     "'phantom_premium_1_5' only");
  }
  const Eigen::Vector3d q(device.pose_rad[0], device.pose_rad[1], device.pose_rad[2]);
  const auto phantom = phantom_parameters(device.parameter_set, device.stylus_mass_kg);
  const Eigen::Matrix3d jacobian = phantom_jacobian(phantom, q);
  if (std::abs(jacobian.determinant()) < 1e-6) {
    throw InputError("scenario '" + scenario.name +
                     "': key device.pose_rad: the device is singular there; choose a pose " +
                     "with the tip off the base axis and the elbow bent");
  }
  const int row = device_row(axis);
  ScenarioTip tip;
  tip.mass_kg = phantom_tip_inertia_kg(phantom, q, axis);
  // Dampers d at every joint let a tip force creep with J J^T / d.
  tip.damping_Ns_per_m = device.joint_viscous_Nms_per_rad / jacobian.row(row).squaredNorm();
  return tip;
}

}  // namespace handloop::models
