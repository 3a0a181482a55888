#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <future>
#include <memory>
#include <thread>

#include "io/recording_file.h"
#include "io/scenario_file.h"
#include "studies/plant_service.h"
#include "tests/support/planted_recording.h"
#include "tests/support/program.h"
#include "tests/ui/desktop.h"

/// The panel as a person meets it: a screen, a mouse, a keyboard. Each test keeps pictures in panel_pictures/.
namespace handloop::ui {
namespace {

class Panel : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!Desktop::possible()) GTEST_SKIP() << "Xvfb and xdotool are needed";
  }
};

bool is(const nlohmann::json& shown, const char* key, const char* value) {
  return shown.contains(key) && shown[key] == value;
}

TEST_F(Panel, FlipsTheVerdictWhenAGainIsTypedAndBackByUndo) {
  Desktop desk({});
  ASSERT_TRUE(desk.until([](const auto& s) { return is(s, "verdict", "STABLE") && s["computing"] == false; }));
  desk.picture("1_stable");
  ASSERT_TRUE(desk.type_value("control.stiffness", "2500", "stiffness_N_per_m")) << desk.shown().dump(1);
  ASSERT_TRUE(desk.until([](const auto& s) { return is(s, "verdict", "UNSTABLE") && s["computing"] == false; }));
  desk.picture("2_unstable");
  desk.keys("ctrl+z");
  ASSERT_TRUE(desk.until([](const auto& s) { return is(s, "verdict", "STABLE") && s["stiffness_N_per_m"] == 400; }));
  desk.keys("ctrl+y");
  ASSERT_TRUE(desk.until([](const auto& s) { return is(s, "verdict", "UNSTABLE"); }));
  EXPECT_EQ(desk.quit(), 0);
}

TEST_F(Panel, SetsTheGainsWhereTheMapIsClicked) {
  Desktop desk({});
  ASSERT_TRUE(desk.until_named("frame.gain_map"));
  ASSERT_TRUE(desk.until([](const auto& s) { return s["computing"] == false && s.contains("map"); }));
  const auto map = desk.shown()["map"];
  desk.click("frame.gain_map", 0.25, 0.5);
  const double K = 0.25 * map["stiffness_high"].get<double>(), B = 0.5 * map["damping_high"].get<double>();
  ASSERT_TRUE(desk.until([&](const auto& s) {
    return std::abs(s["stiffness_N_per_m"].template get<double>() - K) < 0.02 * map["stiffness_high"].get<double>() &&
           std::abs(s["damping_Ns_per_m"].template get<double>() - B) < 0.02 * map["damping_high"].get<double>();
  })) << desk.shown().dump(1);
  desk.picture("3_map_clicked");
  desk.keys("ctrl+z");
  EXPECT_TRUE(desk.until([](const auto& s) { return s["stiffness_N_per_m"] == 400 && s["damping_Ns_per_m"] == 1; }));
}

TEST_F(Panel, StopsByTheEscapeKeyAndByTheButtonUntilReset) {
  Desktop desk({});
  ASSERT_TRUE(desk.until([](const auto& s) { return s["running"] == true; }));
  desk.keys("Escape");
  ASSERT_TRUE(desk.until([](const auto& s) { return is(s, "fault", "external") && s["landmarks"].contains("fault"); }));
  desk.click("button.evidence");
  ASSERT_TRUE(desk.until([](const auto& s) { return is(s, "view", "device"); }));
  ASSERT_TRUE(desk.until_named("plot.evidence_force"));
  desk.picture("4_stopped");
  desk.keys("F5");
  ASSERT_TRUE(desk.until([](const auto& s) { return is(s, "fault", "none") && s["running"] == true; }));
  desk.click("button.stop");
  EXPECT_TRUE(desk.until([](const auto& s) { return is(s, "fault", "external"); })) << desk.shown().dump(1);
}

TEST_F(Panel, ShowsEveryView) {
  Desktop desk({});
  const std::array<const char*, 6> views{"tune", "arms", "subject", "data", "traces", "device"};
  for (std::size_t i = 0; i < views.size(); ++i) {
    desk.keys("ctrl+" + std::to_string(i + 1));
    ASSERT_TRUE(desk.until([&](const auto& s) { return is(s, "view", views[i]); })) << views[i];
  }
  desk.click("button.view_arms");
  desk.click("button.draw");
  ASSERT_TRUE(desk.until([](const auto& s) { return is(s, "arm", "subject 0 of seed 1"); }));
  desk.picture("5_arm_drawn");
  desk.keys("ctrl+t");
  desk.keys("ctrl+5");
  ASSERT_TRUE(desk.until_named("plot.deadlines"));
  desk.picture("6_traces_light");
}

TEST_F(Panel, SavesTheScenarioThatTheCommandLineReads) {
  const auto path = std::filesystem::temp_directory_path() / "handloop_panel_saved.toml";
  std::ofstream(path) << io::to_toml(io::default_scenario());
  {
    Desktop desk({path.string()});
    ASSERT_TRUE(desk.type_value("control.stiffness", "640", "stiffness_N_per_m"));
    desk.keys("ctrl+s");
    ASSERT_TRUE(desk.until([](const auto& s) { return s["changed"] == false; }));
  }
  EXPECT_EQ(io::read_scenario(path).loop.stiffness_N_per_m, 640);
  std::filesystem::remove(path);
}

TEST_F(Panel, ArmsADeviceAcrossTheNetworkByTwoActionsOnly) {
  std::atomic<bool> stop{false};
  std::promise<std::string> ready;
  std::jthread plant([&] {
    studies::PlantServiceOptions options;
    options.scenario = io::default_scenario();
    options.listen = "127.0.0.1:0";
    options.stop = &stop;
    options.on_ready = [&](const std::string& address, bool) { ready.set_value(address); };
    studies::serve_plant(options);
  });
  // whatever happens below, the plant is told to end before its thread is waited for
  const std::shared_ptr<void> ending(nullptr, [&stop](void*) { stop = true; });
  {
    Desktop desk({"--view", "device"});
    desk.click("button.device_udp");
    desk.click("control.device_address");
    desk.keys("ctrl+a");
    desk.type(ready.get_future().get());
    desk.click("button.use_device");
    ASSERT_TRUE(desk.until([](const auto& s) { return s["device"] != "sim" && s["running"] == false; }));
    const auto hold = [&] {
      desk.move_to("button.arm", 0.3);
      desk.press(true);
      std::this_thread::sleep_for(std::chrono::milliseconds(2500));
      desk.press(false);
    };
    hold();  // the cover is shut: nothing may happen
    EXPECT_EQ(desk.shown()["armed"], false);
    EXPECT_EQ(desk.shown()["running"], false);
    desk.click("control.cover", 0.02);
    for (int attempt = 1;; ++attempt) {
      // pressed for as long as it takes: on a busy machine the frames that count the holding are few
      desk.move_to("button.arm", 0.3);
      desk.press(true);
      const bool armed = desk.until([](const auto& s) { return s["armed"] == true || !is(s, "fault", "none"); });
      desk.press(false);
      ASSERT_TRUE(armed) << desk.shown().dump(1);
      if (attempt == 1) desk.picture("9_armed");
      desk.keys("Escape");
      ASSERT_TRUE(desk.until([](const auto& s) { return !is(s, "fault", "none"); })) << desk.shown().dump(1);
      if (is(desk.shown(), "fault", "external")) break;
      // a plant held up by a busy machine stops the device by itself, as it must; armed anew for the key's sake
      ASSERT_TRUE(is(desk.shown(), "fault", "no_reading") && attempt < 10) << desk.shown().dump(1);
      desk.keys("F5");
      ASSERT_TRUE(desk.until([](const auto& s) { return is(s, "fault", "none"); })) << desk.shown().dump(1);
      desk.click("control.cover", 0.02);
    }
  }
}

TEST_F(Panel, ExplainsARecordingAndAppliesWhatItFound) {
  // from the other laboratory of tests/support, not from the code that explains it
  const auto planted = tests::plant_recording("coulomb_friction", 3, {.duration_s = 20.0});
  models::Recording recording;
  recording.sample_time_s = planted.sample_time_s;
  recording.force_N = planted.force;
  recording.position_m = planted.position;
  const auto path = std::filesystem::temp_directory_path() / "handloop_panel_recording.csv";
  io::write_recording(path, recording);
  Desktop desk({"--view", "data"});
  desk.click("control.recording");
  desk.type(path.string());
  desk.keys("Return");
  ASSERT_TRUE(desk.until_named("explain_progress")) << desk.shown().dump(1);
  ASSERT_TRUE(desk.until_named("found") || desk.until_named("found")) << desk.shown().dump(1);
  const double before = desk.shown()["disk_margin"].get<double>();
  desk.picture("7_explained");
  desk.click("button.apply_effect");
  ASSERT_TRUE(desk.until([](const auto& s) { return !s["effects"].empty(); })) << desk.shown().dump(1);
  EXPECT_EQ(desk.shown()["effects"][0], "coulomb_friction");
  EXPECT_TRUE(desk.until([&](const auto& s) { return s["disk_margin"] != before; }));
  ASSERT_TRUE(desk.until_named("applied"));
  desk.picture("8_applied");
  std::filesystem::remove(path);
}

TEST(PanelWithoutADisplay, SaysSoInOneLine) {
  const auto run = test::run_program(
      "/usr/bin/env", {"-u", "DISPLAY", "-u", "WAYLAND_DISPLAY", HANDLOOP_PROGRAM, "panel"}, HANDLOOP_SOURCE_DIR);
  EXPECT_EQ(run.exit_code, 2) << run.err;
  EXPECT_NE(run.err.find("no display"), std::string::npos) << run.err;
  EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
}

TEST(PanelWithoutADisplay, ChecksItsOptionsFirst) {
  for (const auto& [option, value] :
       {std::pair{"--theme", "blue"}, {"--view", "moon"}, {"--size", "12"}, {"--scale", "9"}}) {
    const auto run = test::run_program(HANDLOOP_PROGRAM, {"panel", option, value}, HANDLOOP_SOURCE_DIR);
    EXPECT_EQ(run.exit_code, 2);
    EXPECT_NE(run.err.find(option), std::string::npos) << run.err;
  }
}

}  // namespace
}  // namespace handloop::ui
