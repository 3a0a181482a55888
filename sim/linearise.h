#pragma once

#include <Eigen/Core>

#include "models/scenario.h"

/// The plant as linear algebra, found by asking the simulated one: what MuJoCo holds, arms and loop closure included.
namespace handloop::sim {

/// Inverse inertia at the tip, device frame, 1/kg: acceleration of the tip for a force on it, at rest at the scenario's
/// pose, nobody holding it. Compare models::phantom_tip_mobility. Throws InputError where the scenario cannot be
/// simulated.
Eigen::Matrix3d tip_mobility(const models::Scenario& scenario);

/// One sample of the plant, linearised about rest at the pose: z+ = A z + B u, y = C z. u: force of the motors at the
/// tip by arm axis (N), held; y: tip by arm axis (m). States: three motor angles, their rates, and of each axis
/// position and velocity of the arm's mass. Effects that act on forces enter by their slope at small motion; internal
/// states and delays of effects, signal effects and elastic structure do not. Coulomb friction, having no slope at
/// rest, is left out.
struct LinearisedPlant {
  Eigen::Matrix<double, 12, 12> A;
  Eigen::Matrix<double, 12, 3> B;
  Eigen::Matrix<double, 3, 12> C;
  double sample_time_s = 0.001;
};

/// By central differences of whole samples; relative error about 1e-6. Throws InputError.
LinearisedPlant linearise(const models::Scenario& scenario);

}  // namespace handloop::sim
