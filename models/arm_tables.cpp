#include "models/arm_tables.h"

#include <array>
#include <string>
#include <vector>

#include "models/errors.h"
#include "models/suggest.h"

namespace handloop::models {
namespace {

/// Tables I and II by axis, then grip (1 N, 2 N, 3 N, nominal). Columns: M kg, k1 N/m, k2 N/m, b1 Ns/m, b2 Ns/m.
constexpr std::array<std::array<ArmParameters, 4>, 3> kArms{{
    {{{0.2892, 428.4, 99.45, 2.998, 5.802},
      {0.2869, 448.6, 93.93, 2.443, 5.698},
      {0.2731, 455.5, 96.17, 2.325, 5.629},
      {0.2179, 379.5, 78.75, 1.839, 4.645}}},
    {{{0.4602, 469.69, 121.8, 7.063, 5.996},
      {0.3892, 625.94, 122.2, 5.996, 6.005},
      {0.4186, 671.20, 126.0, 5.858, 6.410},
      {0.2692, 552.4, 105.3, 3.609, 6.430}}},
    {{{0.2115, 843.1, 323.9, 0.7093, 19.42},
      {0.2525, 868.3, 332.8, 0.5882, 19.90},
      {0.2353, 855.1, 355.1, 0.4925, 20.56},
      {0.2041, 769.9, 271.7, 0.7764, 18.06}}},
}};

/// Table III by axis, then parameter. Columns: minimum, mean, maximum, std dev, 95 % CI min and max, 67 % CI min and
/// max.
constexpr std::array<std::array<ParameterStatistics, 5>, 3> kStatistics{{
    {{{0.0340, 0.3240, 0.8016, 0.1464, 0.1433, 0.5664, 0.2527, 0.3759},
      {140.6, 459.4, 757.9, 144.5, 228.0, 650.5, 393.0, 539.6},
      {53.05, 104.8, 196.2, 27.59, 63.20, 151.3, 91.12, 116.8},
      {0.0020, 2.579, 7.095, 1.337, 0.8686, 4.561, 1.957, 2.883},
      {3.148, 5.920, 10.34, 2.192, 3.678, 10.29, 4.372, 6.222}}},
    {{{0.2275, 0.4763, 0.9115, 0.1528, 0.2747, 0.7221, 0.3852, 0.5367},
      {292.3, 620.2, 926.5, 185.8, 313.1, 896.6, 525.1, 738.6},
      {88.66, 132.5, 199.7, 29.05, 90.10, 194.7, 115.5, 144.7},
      {3.830, 6.094, 9.898, 1.403, 4.212, 8.904, 5.304, 6.425},
      {4.020, 5.890, 9.721, 1.398, 4.145, 8.591, 5.150, 6.272}}},
    {{{0.0003, 0.2357, 0.4810, 0.1261, 0.0161, 0.4252, 0.1630, 0.2968},
      {590.3, 886.9, 1050, 105.4, 679.1, 1043, 849.4, 941.0},
      {194.6, 365.8, 588.7, 105.8, 214.1, 533.0, 293.3, 421.6},
      {0.0002, 0.5241, 1.939, 0.4884, 0.0002, 1.420, 0.1091, 0.8081},
      {10.66, 20.14, 28.88, 5.129, 13.09, 27.61, 16.28, 24.67}}},
}};

/// Table V. The paper's number of each reference is kept.
const std::array<LiteratureArm, 7> kLiterature{{
    {"diaz", "Diaz and Gil [25]", "horizontal racquet grip", std::nullopt, {0.22, 3662, 98.6, 1.18, 6.88}, false},
    {"speich_x", "Speich, Shao and Goldfarb [21], X", "stylus", Axis::x, {0.85, 122, 330, 12.9, 12.9}, false},
    {"speich_y", "Speich, Shao and Goldfarb [21], Y", "stylus", Axis::y, {4.03, 108, 104, 9.20, 47.6}, false},
    {"speich_z", "Speich, Shao and Goldfarb [21], Z", "stylus", Axis::z, {0.68, 81.4, 13.0, 17.6, 13.5}, false},
    {"speich_1dof", "Speich, Shao and Goldfarb [21], 1 DOF", "sphere", Axis::z, {1.46, 48.8, 375, 4.5, 7.9}, false},
    {"vlugt", "de Vlugt et al. [35]", "vertical joystick", std::nullopt, {1.88, 14998, 733, 178, 37.3}, false},
    {"kosuge", "Kosuge et al. [15]", "vertical joystick", std::nullopt, {11.6, 0, 243, 0, 17.3}, true},
}};

}  // namespace

Grip parse_grip(std::string_view text) {
  if (text == "1") return Grip::one_N;
  if (text == "2") return Grip::two_N;
  if (text == "3") return Grip::three_N;
  if (text == "nominal") return Grip::nominal;
  throw InputError("unknown grip '" + std::string(text) + "': give 1, 2, 3 (N, Table I) or nominal (Table II)");
}

std::string_view grip_name(Grip grip) {
  return std::array{"1", "2", "3", "nominal"}[static_cast<std::size_t>(grip)];
}

ArmParameters published_arm(Axis axis, Grip grip) {
  return kArms[static_cast<std::size_t>(axis)][static_cast<std::size_t>(grip)];
}

const ParameterStatistics& parameter_statistics(Axis axis, std::size_t parameter) {
  return kStatistics[static_cast<std::size_t>(axis)].at(parameter);
}

AxisModel LiteratureArm::model() const {
  AxisModel model;
  model.axis = axis.value_or(Axis::z);
  if (rigid_grasp) {
    model.base = BaseModel::msd;
    model.msd = {arm.mass_kg, arm.b2_Ns_per_m, arm.k2_N_per_m};
  } else {
    model.arm = arm;
  }
  return model;
}

std::span<const LiteratureArm> literature_arms() {
  return kLiterature;
}

const LiteratureArm& find_literature_arm(std::string_view name) {
  std::vector<std::string_view> known;
  for (const auto& row : kLiterature) {
    if (row.name == name) return row;
    known.push_back(row.name);
  }
  throw InputError("no arm '" + std::string(name) + "' in Table V" + suggestion(name, known));
}

}  // namespace handloop::models
