#pragma once

#include <optional>
#include <span>
#include <string_view>

#include "models/arm.h"
#include "models/axis.h"
#include "models/axis_model.h"

/// The published arms. Tables I, II, III and V of M. J. Fu and M. C. Cavusoglu, "Human-arm-and-hand-dynamic model with
/// variability analyses for a stylus-based haptic interface", IEEE Trans. SMC-B 42(6), 2012, as printed: stylus grip,
/// 15 subjects, 0.6 to 30 Hz. Table IV is models/arm_uncertainty.h.
namespace handloop::models {

/// Grip forces at which Table I was measured, and the nominal arm over all of them (Table II).
enum class Grip { one_N, two_N, three_N, nominal };

/// Accepts "1", "2", "3" (newtons) and "nominal". Throws InputError for anything else.
Grip parse_grip(std::string_view text);
std::string_view grip_name(Grip grip);

/// Table I (grip forces of 1, 2 and 3 N) or Table II (nominal).
ArmParameters published_arm(Axis axis, Grip grip);
/// Table II.
inline ArmParameters nominal_arm(Axis axis) {
  return published_arm(axis, Grip::nominal);
}

/// Table III, one row: the spread of one parameter over 45 fits (15 subjects at 3 grip forces). Units of the parameter.
/// What percentiles the "CI" ends are is not said in the paper: see models/arm_population.h.
struct ParameterStatistics {
  double minimum;
  double mean;
  double maximum;
  double standard_deviation;
  double ci95_minimum;
  double ci95_maximum;
  double ci67_minimum;
  double ci67_maximum;
};

/// Row of Table III; parameter is an index into kArmParameterNames, 0 to 4.
const ParameterStatistics& parameter_statistics(Axis axis, std::size_t parameter);

/// Table V: an arm of another paper. Those of three parameters have no grasp: the hand is rigid with the device.
struct LiteratureArm {
  std::string_view name;     ///< as given on the command line: "speich_z"
  std::string_view source;   ///< authors, with the number of the reference in the arm paper
  std::string_view grasp;    ///< what the hand held
  std::optional<Axis> axis;  ///< direction of motion, where the paper says one
  ArmParameters arm;         ///< k1 and b1 mean nothing where rigid_grasp
  bool rigid_grasp;

  /// The arm as a model: base arm5, or msd where the grasp is rigid. Axis z (forward and backward, as in the paper's
  /// Figure 8) unless it has its own.
  AxisModel model() const;
};

/// Every row of Table V, in its order.
std::span<const LiteratureArm> literature_arms();
/// Row by name. Throws InputError for an unknown one, suggesting the nearest.
const LiteratureArm& find_literature_arm(std::string_view name);

}  // namespace handloop::models
