#pragma once

#include <complex>
#include <string>
#include <vector>

#include "models/arm.h"
#include "models/axis.h"
#include "models/effects/effect.h"

namespace handloop::models {

/// Mass, spring and damper to ground: the base model `msd`. Rotary plants read kg m^2, Nms/rad and Nm/rad.
struct MsdParameters {
  double mass_kg = 0.0;
  double b_Ns_per_m = 0.0;
  double k_N_per_m = 0.0;

  bool operator==(const MsdParameters&) const = default;
};

enum class BaseModel { arm5, msd };

/// One axis of a plant as it stands in a model file: a base model and the effects added to it.
struct AxisModel {
  BaseModel base = BaseModel::arm5;
  Axis axis = Axis::x;
  bool rotary = false;  ///< angles and torques in the place of positions and forces
  ArmParameters arm;    ///< where base is arm5
  MsdParameters msd;    ///< where base is msd
  std::vector<EffectPtr> effects;

  /// Spring, damper and mass beside which an effect at this place stands.
  PortBase port_base(Place place) const;
};

/// Throws InputError naming the parameter that is not possible.
void require_valid(const AxisModel& model);

/// Motion at the places where force effects act, for linearisation.
struct AxisOperatingPoint {
  OperatingPoint arm, grasp, joint;
  const OperatingPoint& at(Place place) const;
};

/// Compliance X/F in m/N at s, the model's effects included by their linear stand-ins: force effects within the plant,
/// signal effects as factors.
std::complex<double> compliance(const AxisModel& model, const AxisOperatingPoint& point, std::complex<double> s);

}  // namespace handloop::models
