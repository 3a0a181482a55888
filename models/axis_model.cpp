#include "models/axis_model.h"

#include <cmath>
#include <string>

#include "models/errors.h"

namespace handloop::models {

PortBase AxisModel::port_base(Place place) const {
  if (base == BaseModel::msd) {
    return place == Place::grasp ? PortBase{} : PortBase{msd.k_N_per_m, msd.b_Ns_per_m, msd.mass_kg};
  }
  if (place == Place::grasp) return {arm.k1_N_per_m, arm.b1_Ns_per_m, 0.0};
  if (place == Place::arm) return {arm.k2_N_per_m, arm.b2_Ns_per_m, arm.mass_kg};
  return {};
}

void require_valid(const AxisModel& model) {
  if (model.base == BaseModel::arm5) return require_valid(model.arm);
  const auto& [mass, b, k] = model.msd;
  const auto check = [](const char* name, double value, bool positive) {
    if (!std::isfinite(value) || value < 0 || (positive && value == 0)) {
      throw InputError(std::string(name) + " = " + std::to_string(value) +
                       " is not possible: it must be a finite number " + (positive ? "above zero" : "of zero or more"));
    }
  };
  check("mass_kg", mass, true);
  check("b_Ns_per_m", b, false);
  check("k_N_per_m", k, false);
}

const OperatingPoint& AxisOperatingPoint::at(Place place) const {
  if (place == Place::grasp) return grasp;
  return place == Place::joint ? joint : arm;
}

std::complex<double> compliance(const AxisModel& model, const AxisOperatingPoint& point, std::complex<double> s) {
  std::complex<double> grasp = 0, arm = 0, grip = 0, factor = 1;
  for (const auto& effect : model.effects) {
    auto linear = effect->linearise(point.at(effect->place()), model.port_base(effect->place()));
    if (effect->place() == Place::grasp) {  // inertia at the grasp moves with the grip
      grip += linear.mass_kg * s * s;
      linear.mass_kg = 0;
    }
    switch (effect->place()) {
      case Place::arm:
        arm += linear(s);
        break;
      case Place::grasp:
        grasp += linear(s);
        break;
      case Place::joint:
        grip += linear(s);
        break;
      case Place::actuator:
      case Place::sensor:
        factor *= linear(s);
        break;
    }
  }
  std::complex<double> held;  // force over motion of the grip
  if (model.base == BaseModel::msd) {
    held = (model.msd.mass_kg * s + model.msd.b_Ns_per_m) * s + model.msd.k_N_per_m + arm;
  } else {
    const auto stiffness_grasp = model.arm.b1_Ns_per_m * s + model.arm.k1_N_per_m + grasp;
    const auto stiffness_arm = (model.arm.mass_kg * s + model.arm.b2_Ns_per_m) * s + model.arm.k2_N_per_m + arm;
    held = 1.0 / (1.0 / stiffness_grasp + 1.0 / stiffness_arm);
  }
  return factor / (held + grip);
}

}  // namespace handloop::models
