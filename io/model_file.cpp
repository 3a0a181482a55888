#include "io/model_file.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "io/effect_tables.h"
#include "io/mapped_file.h"
#include "io/output.h"
#include "io/toml_table.h"
#include "models/errors.h"

namespace handloop::io {
namespace {

using models::AxisModel;
using models::BaseModel;

/// Keys of a base model, translational and rotary.
constexpr std::array<std::string_view, 5> kRotaryArm{"inertia_kg_m2", "k1_Nm_per_rad", "k2_Nm_per_rad",
                                                     "b1_Nms_per_rad", "b2_Nms_per_rad"};
constexpr std::array<std::string_view, 3> kMsd{"mass_kg", "b_Ns_per_m", "k_N_per_m"};
constexpr std::array<std::string_view, 3> kRotaryMsd{"inertia_kg_m2", "b_Nms_per_rad", "k_Nm_per_rad"};

BaseModel read_base(const TomlTable& file) {
  const auto base = file.text("base");
  if (!base) return file.has("msd") && !file.has("arm") ? BaseModel::msd : BaseModel::arm5;
  if (*base == "arm5") return BaseModel::arm5;
  if (*base == "msd") return BaseModel::msd;
  file.fail("base", fmt::format("'{}' is unknown; give \"arm5\" or \"msd\"", *base));
}

/// The base model's numbers, from whichever of the two sets of keys the table uses. The first (mass) and, where
/// `second_positive`, the second must be above zero.
template <std::size_t N>
std::array<double, N> read_parameters(const TomlTable& table, const std::array<std::string_view, N>& translational,
                                      const std::array<std::string_view, N>& rotary_keys, bool second_positive,
                                      bool& rotary) {
  rotary = false;
  for (const auto key : rotary_keys) rotary = rotary || table.has(key);
  const auto& keys = rotary ? rotary_keys : translational;
  const auto& other = rotary ? translational : rotary_keys;
  for (const auto key : other) {
    if (table.has(key)) table.fail(key, fmt::format("does not go with {}: use rotary keys only, or none", keys[0]));
  }
  std::vector<std::string_view> allowed(keys.begin(), keys.end());
  allowed.push_back("axis");
  table.allow_only(allowed);
  std::array<double, N> values{};
  for (std::size_t i = 0; i < N; ++i) {
    values[i] = table.required_number(keys[i]);
    const bool positive = i == 0 || (i == 1 && second_positive);
    if (values[i] < 0 || (positive && values[i] == 0)) {
      table.fail(keys[i], fmt::format("{:g} is not possible; give a number {}", values[i],
                                      positive ? "above 0" : "of 0 or more"));
    }
  }
  return values;
}

models::Axis read_axis(const TomlTable& table) {
  const auto text = table.required_text("axis");
  for (const auto axis : models::kAxes) {
    if (text == models::axis_name(axis)) return axis;
  }
  table.fail(
      "axis",
      fmt::format("'{}' is unknown; give \"x\" (left-right), \"y\" (up-down) or \"z\" (forward-backward)", text));
}

}  // namespace

AxisModel parse_model(std::string_view text, const std::string& name) {
  const auto parsed = parse_toml(text, name);
  const TomlTable file(parsed, name, "");
  file.allow_only({"base", "arm", "msd", "effect"});
  AxisModel model;
  model.base = read_base(file);
  const bool is_arm = model.base == BaseModel::arm5;
  const auto* const wanted = is_arm ? "arm" : "msd";
  const auto* const other = is_arm ? "msd" : "arm";
  if (file.has(other)) file.fail(other, fmt::format("does not belong to base \"{}\"", is_arm ? "arm5" : "msd"));
  const auto table = file.table(wanted);
  if (!table) throw InputError(fmt::format("{}: lacks the table [{}]", name, wanted));
  if (is_arm) {
    model.arm =
        models::arm_from_array(read_parameters(*table, models::kArmParameterNames, kRotaryArm, true, model.rotary));
    model.axis = read_axis(*table);
  } else {
    const auto [mass, damping, stiffness] = read_parameters(*table, kMsd, kRotaryMsd, false, model.rotary);
    model.msd = {mass, damping, stiffness};
    if (table->has("axis")) model.axis = read_axis(*table);
  }
  for (const auto& effect : file.tables("effect")) model.effects.push_back(read_effect(effect));
  return model;
}

AxisModel read_model(const std::filesystem::path& path) {
  return parse_model(read_file(path), path.string());
}

std::string to_toml(const AxisModel& model) {
  const bool is_arm = model.base == BaseModel::arm5;
  auto text = fmt::format("base = \"{0}\"\n\n[{1}]\naxis = \"{2}\"\n", is_arm ? "arm5" : "msd", is_arm ? "arm" : "msd",
                          models::axis_name(model.axis));
  if (is_arm) {
    const auto& keys = model.rotary ? kRotaryArm : models::kArmParameterNames;
    const auto values = models::to_array(model.arm);
    for (std::size_t i = 0; i < keys.size(); ++i) text += fmt::format("{} = {}\n", keys[i], toml_number(values[i]));
  } else {
    const auto& keys = model.rotary ? kRotaryMsd : kMsd;
    const std::array values{model.msd.mass_kg, model.msd.b_Ns_per_m, model.msd.k_N_per_m};
    for (std::size_t i = 0; i < keys.size(); ++i) text += fmt::format("{} = {}\n", keys[i], toml_number(values[i]));
  }
  for (const auto& effect : model.effects) text += "\n" + effect_to_toml(*effect);
  return text;
}

void write_model(const std::filesystem::path& path, const AxisModel& model) {
  write_file_atomically(path, to_toml(model));
}

}  // namespace handloop::io
