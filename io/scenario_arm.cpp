#include "io/scenario_arm.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "io/effect_tables.h"
#include "io/model_file.h"
#include "models/arm_tables.h"
#include "models/errors.h"
#include "models/suggest.h"

namespace handloop::io::detail {
namespace {

using models::ArmParameters;
using models::Axis;

/// Table V has arms without a grasp: the hand is one with the device. Here that is a grasp a hundred times as stiff as
/// the arm is at 30 Hz, damped so that no pole is faster than about 2000 1/s.
ArmParameters held_stiffly(const models::MsdParameters& msd) {
  const double highest_rad_per_s = 2 * std::numbers::pi * 30;
  const double arm_N_per_m = msd.k_N_per_m + highest_rad_per_s * (msd.b_Ns_per_m + highest_rad_per_s * msd.mass_kg);
  const double grasp_N_per_m = 100 * arm_N_per_m;
  return {msd.mass_kg, grasp_N_per_m, msd.k_N_per_m, std::sqrt(grasp_N_per_m * msd.mass_kg), msd.b_Ns_per_m};
}

ArmParameters arm_of(const models::AxisModel& model) {
  return model.base == models::BaseModel::arm5 ? model.arm : held_stiffly(model.msd);
}

ArmParameters from_literature(const TomlTable& table) {
  const auto name = *table.text("literature");
  std::vector<std::string_view> known;
  for (const auto& arm : models::literature_arms()) {
    if (arm.name == name) return arm_of(arm.model());
    known.push_back(arm.name);
  }
  table.fail("literature", fmt::format("unknown arm '{}'{}", name, suggestion(name, known)));
}

/// One of the four ways to name an arm: grip, literature, model or the five numbers.
void read_arm(const TomlTable& table, Axis axis, const std::filesystem::path& folder, models::ArmSettings& settings) {
  std::vector<std::string_view> keys{"grip", "literature", "model"};
  keys.insert(keys.end(), models::kArmParameterNames.begin(), models::kArmParameterNames.end());
  table.allow_only(keys);
  const bool by_numbers = std::any_of(models::kArmParameterNames.begin(), models::kArmParameterNames.end(),
                                      [&](auto key) { return table.has(key); });
  const int ways = table.has("grip") + table.has("literature") + table.has("model") + by_numbers;
  if (ways != 1) {
    table.fail(fmt::format("{}: give one of grip, literature, model, or the five parameters mass_kg to b2_Ns_per_m",
                           ways == 0 ? "names no arm" : "names an arm in several ways"));
  }
  auto& arm = settings.axes[static_cast<std::size_t>(axis)];
  if (table.has("literature")) {
    arm = from_literature(table);
  } else if (table.has("model")) {
    // The file's own message is the better one where it cannot be read.
    const auto model = read_model(folder / *table.text("model"));
    if (model.rotary) table.fail("model", "describes a rotary plant; an arm moves along its axis");
    arm = arm_of(model);
    for (const auto& effect : model.effects) settings.effects.emplace_back(axis, effect);
  } else if (table.has("grip")) {
    const auto grip = *table.text("grip");
    try {
      arm = models::published_arm(axis, models::parse_grip(grip));
    } catch (const InputError&) {
      table.fail("grip", fmt::format("'{}' is unknown; give \"1\", \"2\", \"3\" (newtons) or \"nominal\"", grip));
    }
  } else {
    std::array<double, 5> values{};
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = table.required_number(models::kArmParameterNames[i]);
    arm = models::arm_from_array(values);
    try {
      models::require_valid(arm);
    } catch (const InputError& error) {
      table.fail(error.what());
    }
  }
}

}  // namespace

void read_arms(const TomlTable& arm, const std::filesystem::path& folder, models::ArmSettings& settings) {
  for (const auto axis : models::kAxes) {
    if (const auto table = arm.table(models::axis_name(axis))) read_arm(*table, axis, folder, settings);
  }
  for (const auto& effect : arm.tables("effect")) {
    const auto word = effect.required_text("axis");
    const auto axis = std::find_if(models::kAxes.begin(), models::kAxes.end(),
                                   [&](Axis candidate) { return word == models::axis_name(candidate); });
    if (axis == models::kAxes.end())
      effect.fail("axis", fmt::format("'{}' is unknown; give \"x\", \"y\" or \"z\"", word));
    settings.effects.emplace_back(*axis, read_effect(effect, {"axis"}));
  }
}

std::string arms_to_toml(const models::ArmSettings& settings) {
  std::string text;
  for (const auto axis : models::kAxes) {
    text += fmt::format("\n[arm.{}]\n", models::axis_name(axis));
    const auto values = models::to_array(settings.axes[static_cast<std::size_t>(axis)]);
    for (std::size_t i = 0; i < values.size(); ++i) {
      text += fmt::format("{} = {}\n", models::kArmParameterNames[i], toml_number(values[i]));
    }
  }
  for (const auto& [axis, effect] : settings.effects) {
    text += "\n" + effect_to_toml(*effect, "arm.effect", fmt::format("axis = \"{}\"\n", models::axis_name(axis)));
  }
  return text;
}

}  // namespace handloop::io::detail
