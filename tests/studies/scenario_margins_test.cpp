#include "studies/scenario_margins.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "control/margins.h"
#include "io/model_file.h"
#include "io/scenario_file.h"
#include "models/scenario_tip.h"
#include "studies/seven_bar_margins.h"

namespace handloop::studies {
namespace {

models::Scenario wall() {
  return io::read_scenario(std::filesystem::path(HANDLOOP_SOURCE_DIR) / "scenes/phantom_wall.toml");
}

ScenarioMarginsRequest quick() {
  ScenarioMarginsRequest request;
  request.arms = 300;
  request.permitted_stiffness = false;
  return request;
}

TEST(ScenarioMargins, TakeTheTipAtThePoseAndTheArmOfTheWallsAxis) {
  const auto scenario = wall();
  const auto r = scenario_margins(scenario, quick());
  const auto tip = models::tip_of(scenario, scenario.wall.axis);
  control::Loop loop;
  loop.plant = {tip.mass_kg, tip.damping_Ns_per_m, scenario.arm.axes[static_cast<std::size_t>(scenario.wall.axis)]};
  loop.gains = {scenario.loop.stiffness_N_per_m, scenario.loop.damping_Ns_per_m};
  EXPECT_EQ(r.nominal.disk_alpha, control::evaluate(loop).disk_alpha);
}

TEST(ScenarioMargins, SayEverythingTheContractAsks) {
  const auto j = to_json(scenario_margins(wall(), quick()));
  for (const char* key : {"stable", "rho", "gm_up", "gm_down", "pm_deg", "dm_s", "sm", "disk_alpha"})
    EXPECT_TRUE(j.at("nominal").contains(key)) << key;
  EXPECT_GT(j.at("robust").at("max").at("peak").get<double>(), 1);
  EXPECT_GT(j.at("robust").at("67").at("peak").get<double>(), 0);
  EXPECT_TRUE(j.at("mu").at("percent95").contains("upper"));
  EXPECT_TRUE(j.at("passivity").at("colgate").contains("without_delay"));
  const auto& p = j.at("population");
  EXPECT_LE(p.at("p_stable_lo95").get<double>(), p.at("p_stable").get<double>());
  EXPECT_GE(p.at("p_stable_hi95").get<double>(), p.at("p_stable").get<double>());
  for (const char* key : {"gm_up", "gm_down", "pm_deg", "dm_s", "sm", "disk_alpha"})
    EXPECT_TRUE(p.at("p05").contains(key)) << key;
}

TEST(ScenarioMargins, AnEffectEntersThem) {
  auto scenario = wall();
  scenario.arm.effects.emplace_back(scenario.wall.axis,
                                    models::make_typical_effect("time_delay", models::Place::sensor));
  const auto r = scenario_margins(scenario, quick());
  ASSERT_TRUE(r.has_effects);
  ASSERT_TRUE(r.without_effects.has_value());
  ASSERT_TRUE(r.nominal.stable);
  // 5 ms later: the delay margin has shrunk by just that, sampling of the late signal aside
  EXPECT_NEAR(r.nominal.delay_s, r.without_effects->delay_s - 0.005, 3e-5);
}

TEST(ScenarioMargins, OfAnUnstableLoopAreNull) {
  auto scenario = wall();
  scenario.loop.stiffness_N_per_m = 5000;
  const auto j = to_json(scenario_margins(scenario, quick()));
  EXPECT_FALSE(j.at("stable").get<bool>());
  EXPECT_TRUE(j.at("nominal").at("gm_up").is_null());
  EXPECT_TRUE(j.at("nominal").at("disk_alpha").is_null());
  EXPECT_NE(to_text(scenario_margins(scenario, quick())).find("UNSTABLE"), std::string::npos);
}

TEST(ScenarioMargins, OfAFreeTipLeaveTheArmsOut) {
  auto scenario = wall();
  scenario.arm.attached = false;
  scenario.loop.stiffness_N_per_m = 5;
  scenario.loop.damping_Ns_per_m = 0.05;
  const auto j = to_json(scenario_margins(scenario, quick()));
  EXPECT_FALSE(j.contains("population"));
  EXPECT_TRUE(j.contains("passivity"));
}

TEST(ScenarioMargins, WriteAReportAndTheWorstArms) {
  const auto directory = std::filesystem::temp_directory_path() / "handloop_scenario_margins_test";
  std::filesystem::remove_all(directory);
  const auto request = quick();
  write_scenario_margins(scenario_margins(wall(), request), request, directory.string());
  for (const char* file : {"report.html", "margins.json", "boundaries.csv", "loop_response.csv", "population.csv"}) {
    EXPECT_GT(std::filesystem::file_size(directory / file), 500U) << file;
  }
  EXPECT_NO_THROW(io::read_model(directory / "worst_arm_1.toml"));
  std::filesystem::remove_all(directory);
}

TEST(SevenBarMargins, AreStableWhereTheExperimentWas) {
  const auto r =
      seven_bar_margins(io::read_scenario(std::filesystem::path(HANDLOOP_SOURCE_DIR) / "scenes/seven_bar.toml"));
  EXPECT_TRUE(r.printed[0].result.margins.stable);
  EXPECT_TRUE(r.printed[1].result.margins.stable);
  EXPECT_FALSE(r.printed[2].result.margins.stable);
  EXPECT_NEAR(r.alpha_limit, 12.49, 0.01);
}

}  // namespace
}  // namespace handloop::studies
