#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "models/arm_tables.h"
#include "models/scenario.h"
#include "ui/state/history.h"

namespace handloop::ui {

/// The scenario on the bench: what every view shows and changes, with undo, and the file it lives in. Holds no physics
/// and no window.
class ScenarioEditor {
 public:
  explicit ScenarioEditor(models::Scenario scenario, std::filesystem::path path = {});

  const models::Scenario& scenario() const { return history_.now(); }
  models::Axis axis() const { return scenario().wall.axis; }
  /// The arm on the wall's axis.
  const models::ArmParameters& arm() const;
  /// Counts changes, undo and redo included: whoever computes from the scenario compares it.
  std::uint64_t revision() const { return revision_; }

  /// Changes the scenario through a function; edits of one name are one undo step until seal().
  void edit(const std::string& name, const std::function<void(models::Scenario&)>& change);
  void seal() { history_.seal(); }
  bool undo();
  bool redo();
  const History<models::Scenario>& history() const { return history_; }

  void set_gains(double stiffness_N_per_m, double damping_Ns_per_m);
  /// Wall, and the hand that pushes against it, along another axis.
  void set_axis(models::Axis axis);
  /// An arm for the wall's axis; `source` says in words whose it is.
  void set_arm(const models::ArmParameters& arm, const std::string& source);
  /// Arms of Table I or II on all axes.
  void set_grip(models::Grip grip);
  /// Arm number `index` of the population, on the wall's axis.
  void draw_subject(std::uint64_t seed, std::uint64_t index);
  void add_effect(models::EffectPtr effect, models::Axis axis);
  void remove_effect(std::size_t index);
  /// Found effects beside whatever stands on the wall's axis; one of the same name and place there is replaced.
  void apply_effects(const std::vector<models::EffectPtr>& effects);
  /// A whole model in the place of the arm and the effects on the wall's axis. Throws InputError for a rotary one.
  void apply_model(const models::AxisModel& model);
  /// Whose arm is on the wall's axis, in words: "Table II, nominal".
  std::string arm_source() const;

  const std::filesystem::path& path() const { return path_; }
  /// Not yet saved.
  bool changed() const { return revision_ != saved_revision_; }
  /// Throws InputError, and nothing changes.
  void load(const std::filesystem::path& path);
  /// The file that the command line reads. Throws InputError.
  void save(const std::filesystem::path& path);

 private:
  History<models::Scenario> history_;
  std::filesystem::path path_;
  std::uint64_t revision_ = 1, saved_revision_ = 1;
  std::string named_source_;           ///< of the arm below
  models::ArmParameters named_arm_{};  ///< drawn or taken from a table by name
};

}  // namespace handloop::ui
