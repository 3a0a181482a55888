#include <gtest/gtest.h>

#include <filesystem>

#include "io/scenario_file.h"
#include "models/arm_population.h"
#include "models/errors.h"
#include "ui/state/arming.h"
#include "ui/state/gain_map.h"
#include "ui/state/grip_colour.h"
#include "ui/state/history.h"
#include "ui/state/scenario_editor.h"
#include "ui/state/verdict.h"

namespace handloop::ui {
namespace {

TEST(History, TakesBackAndBringsAgain) {
  History<int> history(1);
  EXPECT_FALSE(history.undo());
  history.edit(2, "a");
  history.seal();
  history.edit(3, "a");
  EXPECT_TRUE(history.undo());
  EXPECT_EQ(history.now(), 2);
  EXPECT_TRUE(history.undo());
  EXPECT_EQ(history.now(), 1);
  EXPECT_FALSE(history.undo());
  EXPECT_TRUE(history.redo());
  EXPECT_EQ(history.now(), 2);
}

TEST(History, MakesOneStepOfADrag) {
  History<int> history(0);
  for (int i = 1; i <= 50; ++i) history.edit(i, "stiffness");
  EXPECT_EQ(history.now(), 50);
  EXPECT_TRUE(history.undo());
  EXPECT_EQ(history.now(), 0);
}

TEST(History, KeepsTwoQuantitiesApart) {
  History<int> history(0);
  history.edit(1, "stiffness");
  history.edit(2, "damping");
  history.undo();
  EXPECT_EQ(history.now(), 1);
}

TEST(History, ForgetsTheFutureOnANewEdit) {
  History<int> history(0);
  history.edit(1, "a");
  history.undo();
  history.edit(2, "b");
  EXPECT_FALSE(history.can_redo());
  history.undo();
  EXPECT_EQ(history.now(), 0);
}

TEST(History, IsBounded) {
  History<int> history(0);
  for (int i = 1; i < 2000; ++i) {
    history.edit(i, "a");
    history.seal();
  }
  int steps = 0;
  while (history.undo()) ++steps;
  EXPECT_LE(steps, 500);
  EXPECT_EQ(history.now(), 1999 - steps);
}

ScenarioEditor fresh() {
  return ScenarioEditor(io::default_scenario());
}

TEST(ScenarioEditor, CountsEveryChangeSoThatNothingStaleIsShown) {
  auto editor = fresh();
  const auto first = editor.revision();
  editor.set_gains(700, 2);
  EXPECT_NE(editor.revision(), first);
  const auto second = editor.revision();
  EXPECT_TRUE(editor.undo());
  EXPECT_NE(editor.revision(), second);
  EXPECT_EQ(editor.scenario().loop.stiffness_N_per_m, 400);
}

TEST(ScenarioEditor, SavesWhatTheCommandLineReadsAndLoadsItBack) {
  const auto path = std::filesystem::temp_directory_path() / "handloop_panel_scenario.toml";
  auto editor = fresh();
  editor.set_gains(1234.5, 2.25);
  editor.draw_subject(3, 17);
  editor.add_effect(models::make_typical_effect("coulomb_friction", models::Place::arm), editor.axis());
  EXPECT_TRUE(editor.changed());
  editor.save(path);
  EXPECT_FALSE(editor.changed());
  EXPECT_EQ(io::to_toml(io::read_scenario(path)), io::to_toml(editor.scenario()));
  auto other = fresh();
  other.load(path);
  EXPECT_EQ(io::to_toml(other.scenario()), io::to_toml(editor.scenario()));
  EXPECT_FALSE(other.history().can_undo());
  std::filesystem::remove(path);
}

TEST(ScenarioEditor, KeepsWhatItHasWhereAFileCannotBeRead) {
  auto editor = fresh();
  editor.set_gains(1000, 1);
  EXPECT_THROW(editor.load("/nowhere/at_all.toml"), InputError);
  EXPECT_EQ(editor.scenario().loop.stiffness_N_per_m, 1000);
}

TEST(ScenarioEditor, SaysWhoseArmItIs) {
  auto editor = fresh();
  EXPECT_EQ(editor.arm_source(), "Table II, nominal");
  editor.set_grip(models::Grip::three_N);
  EXPECT_EQ(editor.arm_source(), "Table I, 3 N grip");
  EXPECT_EQ(editor.scenario().arm.grip_force_N, 3.0);
  editor.draw_subject(1, 4);
  EXPECT_EQ(editor.arm_source(), "subject 4 of seed 1");
  EXPECT_EQ(editor.arm(), models::ArmPopulation(editor.axis()).sample(1, 4));
  editor.edit("mass", [](models::Scenario& s) { s.arm.axes[2].mass_kg *= 1.01; });
  EXPECT_EQ(editor.arm_source(), "an arm of your own");
  editor.undo();
  EXPECT_EQ(editor.arm_source(), "subject 4 of seed 1");
}

TEST(ScenarioEditor, AppliesAFoundEffectOnceAndInOneUndoStep) {
  auto editor = fresh();
  const auto friction = models::make_typical_effect("coulomb_friction", models::Place::arm);
  const auto reflex = models::make_typical_effect("reflex_feedback", models::Place::arm);
  editor.apply_effects({friction, reflex});
  editor.apply_effects({friction, reflex});
  EXPECT_EQ(editor.scenario().arm.effects.size(), 2u);
  editor.undo();
  editor.undo();
  EXPECT_TRUE(editor.scenario().arm.effects.empty());
}

TEST(ScenarioEditor, RefusesToHoldTheStylusWithARotaryModel) {
  auto editor = fresh();
  models::AxisModel model;
  model.rotary = true;
  EXPECT_THROW(editor.apply_model(model), InputError);
}

studies::NominalTuning tuned(double stiffness, double damping = 1.0) {
  auto scenario = io::default_scenario();
  scenario.loop.stiffness_N_per_m = stiffness;
  scenario.loop.damping_Ns_per_m = damping;
  return studies::tune_nominal(scenario);
}

TEST(Verdict, FlipsWhereTheLoopBecomesUnstable) {
  const auto limit = studies::tune_robust(io::default_scenario()).critical_stiffness_N_per_m;
  EXPECT_EQ(verdict_of(tuned(0.999 * limit), {}).word, "STABLE");
  EXPECT_EQ(verdict_of(tuned(1.001 * limit), {}).word, "UNSTABLE");
}

TEST(Verdict, NamesNoMarginOfAnUnstableLoop) {
  const auto scenario = io::default_scenario();
  for (const auto& figure : figures_of(tuned(20000), studies::tune_robust(scenario), {})) {
    const bool margin = figure.name == "Gain" || figure.name == "Phase" || figure.name == "Delay" ||
                        figure.name == "Disk margin" || figure.name == "Robust peak";
    EXPECT_EQ(margin, figure.value == "none") << figure.name;
  }
}

TEST(Verdict, DoubtsAWallThatTooManyArmsDoNotHold) {
  auto scenario = io::default_scenario();
  scenario.loop.stiffness_N_per_m = 1400;  // below this arm's limit of 1458, above that of many others
  const auto population = studies::tune_population(scenario, 300, 1);
  const auto nominal = studies::tune_nominal(scenario);
  ASSERT_TRUE(nominal.margins.stable);
  ASSERT_LT(population.stable.estimate, 0.95);
  EXPECT_EQ(verdict_of(nominal, population).outlook, Outlook::doubtful);
}

TEST(Tuning, DrawsTheBoundaryWhereTheVerdictFlipsWithEffectsToo) {
  auto scenario = io::default_scenario();
  scenario.arm.effects.emplace_back(models::Axis::z,
                                    models::make_typical_effect("cubic_stiffness", models::Place::arm));
  const auto robust = studies::tune_robust(scenario);
  std::size_t judged = 0;
  for (const auto& piece : robust.boundary) {
    for (std::size_t i = 0; i < piece.points.size(); i += 12) {
      const auto& point = piece.points[i];
      if (point.stiffness_N_per_m <= 0) continue;
      auto at = scenario;
      at.loop.damping_Ns_per_m = point.damping_Ns_per_m;
      at.loop.stiffness_N_per_m = 0.99 * point.stiffness_N_per_m;
      EXPECT_TRUE(studies::tune_nominal(at).margins.stable) << point.stiffness_N_per_m << ' ' << point.damping_Ns_per_m;
      at.loop.stiffness_N_per_m = 1.01 * point.stiffness_N_per_m;
      EXPECT_FALSE(studies::tune_nominal(at).margins.stable)
          << point.stiffness_N_per_m << ' ' << point.damping_Ns_per_m;
      ++judged;
    }
  }
  EXPECT_GE(judged, 3u);
}

TEST(Tuning, PutsEveryArmOfTheCloudOnItsOwnBoundary) {
  const auto scenario = io::default_scenario();
  const auto limits = studies::population_limits(scenario, 40, 1, {0, 3000, 0, 4});
  ASSERT_TRUE(limits);
  ASSERT_EQ(limits->cloud.size(), 40u);
  for (std::size_t i = 0; i < 40; ++i) {
    auto at = scenario;
    at.arm.axes[2] = models::ArmPopulation(models::Axis::z).sample(1, i);
    at.loop.damping_Ns_per_m = limits->cloud[i].damping_Ns_per_m;
    at.loop.stiffness_N_per_m = 0.999 * limits->cloud[i].stiffness_N_per_m;
    EXPECT_TRUE(studies::tune_nominal(at).margins.stable) << i;
    at.loop.stiffness_N_per_m = 1.001 * limits->cloud[i].stiffness_N_per_m;
    EXPECT_FALSE(studies::tune_nominal(at).margins.stable) << i;
  }
}

TEST(GainMap, GivesTheGainsUnderTheMouse) {
  const control::GainWindow window{0, 2000, 0, 4};
  const auto middle = gains_at(window, {0.5, 0.25});
  EXPECT_DOUBLE_EQ(middle.stiffness_N_per_m, 1000);
  EXPECT_DOUBLE_EQ(middle.damping_Ns_per_m, 1);
  const auto outside = gains_at(window, {1.7, -0.3});
  EXPECT_DOUBLE_EQ(outside.stiffness_N_per_m, 2000);
  EXPECT_DOUBLE_EQ(outside.damping_Ns_per_m, 0);
  EXPECT_NEAR(gains_at(window, {0.1234, 0}).stiffness_N_per_m, 246.8, 10.0);
}

TEST(Arming, TakesTwoDeliberateActions) {
  Arming arming;
  EXPECT_FALSE(arming.hold(true, 0.0));  // the cover is shut
  EXPECT_FALSE(arming.hold(true, 10.0));
  arming.open_cover(10.0);
  EXPECT_FALSE(arming.hold(true, 10.1));
  EXPECT_FALSE(arming.hold(true, 11.5));
  EXPECT_TRUE(arming.hold(true, 11.7));
  EXPECT_TRUE(arming.armed());
}

TEST(Arming, StartsOverWhereTheButtonIsLetGo) {
  Arming arming;
  arming.open_cover(0.0);
  arming.hold(true, 0.0);
  arming.hold(false, 1.4);
  EXPECT_FALSE(arming.hold(true, 1.5));
  EXPECT_FALSE(arming.hold(true, 2.9));
  EXPECT_TRUE(arming.hold(true, 3.1));
}

TEST(Arming, ShutsACoverThatWasForgotten) {
  Arming arming;
  arming.open_cover(0.0);
  arming.hold(false, 21.0);
  EXPECT_FALSE(arming.cover_open());
  EXPECT_FALSE(arming.hold(true, 22.0));
  EXPECT_FALSE(arming.hold(true, 30.0));
}

TEST(Arming, IsLostOnDisarming) {
  Arming arming;
  arming.open_cover(0.0);
  arming.hold(true, 0.0);
  ASSERT_TRUE(arming.hold(true, 2.0));
  arming.disarm();
  EXPECT_FALSE(arming.armed());
  EXPECT_FALSE(arming.hold(true, 9.0));
}

TEST(GripColour, NamesTheThreeForcesOfThePaper) {
  EXPECT_EQ(grip_label(0.2), GripLabel::none);
  EXPECT_EQ(grip_label(1.0), GripLabel::one_N);
  EXPECT_EQ(grip_label(1.4), GripLabel::one_N);
  EXPECT_EQ(grip_label(2.0), GripLabel::two_N);
  EXPECT_EQ(grip_label(3.2), GripLabel::three_N);
  EXPECT_EQ(grip_label(5.0), GripLabel::none);
  EXPECT_EQ(grip_label(NAN), GripLabel::none);
}

}  // namespace
}  // namespace handloop::ui
