#include "ui/state/scenario_editor.h"

#include <fmt/format.h>

#include "io/output.h"
#include "io/scenario_file.h"
#include "models/arm_population.h"

namespace handloop::ui {
namespace {

std::size_t index(models::Axis axis) {
  return static_cast<std::size_t>(axis);
}

std::string grip_words(models::Grip grip) {
  return grip == models::Grip::nominal ? "Table II, nominal" : fmt::format("Table I, {} N grip", grip_name(grip));
}

double grip_N(models::Grip grip) {
  return grip == models::Grip::one_N ? 1.0 : grip == models::Grip::three_N ? 3.0 : 2.0;
}

}  // namespace

ScenarioEditor::ScenarioEditor(models::Scenario scenario, std::filesystem::path path)
    : history_(std::move(scenario)), path_(std::move(path)) {}

const models::ArmParameters& ScenarioEditor::arm() const {
  return scenario().arm.axes[index(axis())];
}

void ScenarioEditor::edit(const std::string& name, const std::function<void(models::Scenario&)>& change) {
  auto changed = scenario();
  change(changed);
  history_.edit(std::move(changed), name);
  ++revision_;
}

bool ScenarioEditor::undo() {
  if (!history_.undo()) return false;
  ++revision_;
  return true;
}

bool ScenarioEditor::redo() {
  if (!history_.redo()) return false;
  ++revision_;
  return true;
}

void ScenarioEditor::set_gains(double stiffness_N_per_m, double damping_Ns_per_m) {
  edit("gains", [&](models::Scenario& s) {
    s.loop.stiffness_N_per_m = stiffness_N_per_m;
    s.loop.damping_Ns_per_m = damping_Ns_per_m;
  });
}

void ScenarioEditor::set_axis(models::Axis axis) {
  edit("axis", [&](models::Scenario& s) { s.wall.axis = s.hand.axis = axis; });
  seal();
}

void ScenarioEditor::set_arm(const models::ArmParameters& arm, const std::string& source) {
  named_arm_ = arm;
  named_source_ = source;
  edit("arm: " + source, [&](models::Scenario& s) {
    s.arm.attached = true;
    s.arm.axes[index(s.wall.axis)] = arm;
    s.arm.rigid[index(s.wall.axis)].reset();
  });
  seal();
}

void ScenarioEditor::set_grip(models::Grip grip) {
  edit("grip", [&](models::Scenario& s) {
    s.arm.attached = true;
    s.arm.grip_force_N = grip_N(grip);
    for (const auto axis : models::kAxes) {
      s.arm.axes[index(axis)] = models::published_arm(axis, grip);
      s.arm.rigid[index(axis)].reset();
    }
  });
  seal();
}

void ScenarioEditor::draw_subject(std::uint64_t seed, std::uint64_t number) {
  set_arm(models::ArmPopulation(axis()).sample(seed, number), fmt::format("subject {} of seed {}", number, seed));
}

void ScenarioEditor::add_effect(models::EffectPtr effect, models::Axis axis) {
  edit("add " + std::string(effect->info().title),
       [&](models::Scenario& s) { s.arm.effects.emplace_back(axis, effect); });
  seal();
}

void ScenarioEditor::remove_effect(std::size_t number) {
  if (number >= scenario().arm.effects.size()) return;
  edit("remove an effect",
       [&](models::Scenario& s) { s.arm.effects.erase(s.arm.effects.begin() + static_cast<std::ptrdiff_t>(number)); });
  seal();
}

void ScenarioEditor::apply_effects(const std::vector<models::EffectPtr>& effects) {
  edit("apply what was found", [&](models::Scenario& s) {
    for (const auto& effect : effects) {
      std::erase_if(s.arm.effects, [&](const auto& entry) {
        return entry.first == s.wall.axis && entry.second->info().name == effect->info().name &&
               entry.second->place() == effect->place();
      });
      s.arm.effects.emplace_back(s.wall.axis, effect);
    }
  });
  seal();
}

void ScenarioEditor::apply_model(const models::AxisModel& model) {
  if (model.rotary) throw InputError("this model is of angles and torques; it cannot hold the stylus");
  edit("apply the found model", [&](models::Scenario& s) {
    s.arm.attached = true;
    auto& rigid = s.arm.rigid[index(s.wall.axis)];
    rigid.reset();
    if (model.base == models::BaseModel::msd) {
      rigid = model.msd;
    } else {
      s.arm.axes[index(s.wall.axis)] = model.arm;
    }
    std::erase_if(s.arm.effects, [&](const auto& entry) { return entry.first == s.wall.axis; });
    for (const auto& effect : model.effects) s.arm.effects.emplace_back(s.wall.axis, effect);
  });
  seal();
}

std::string ScenarioEditor::arm_source() const {
  if (!scenario().arm.attached) return "nobody holds the device";
  if (scenario().arm.rigid[index(axis())]) return "a hand that is one with the stylus";
  if (!named_source_.empty() && named_arm_ == arm()) return named_source_;
  for (const auto grip : {models::Grip::nominal, models::Grip::one_N, models::Grip::two_N, models::Grip::three_N}) {
    if (models::published_arm(axis(), grip) == arm()) return grip_words(grip);
  }
  return "an arm of your own";
}

void ScenarioEditor::load(const std::filesystem::path& path) {
  history_.restart(io::read_scenario(path));
  path_ = path;
  saved_revision_ = ++revision_;
}

void ScenarioEditor::save(const std::filesystem::path& path) {
  io::write_file_atomically(path, io::to_toml(scenario()));
  path_ = path;
  saved_revision_ = revision_;
}

}  // namespace handloop::ui
