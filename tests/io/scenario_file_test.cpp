#include "io/scenario_file.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "io/mapped_file.h"
#include "io/output.h"
#include "models/arm_tables.h"
#include "models/errors.h"

namespace handloop::io {
namespace {
namespace fs = std::filesystem;
using models::Axis;

std::string refusal(const std::string& text) {
  try {
    parse_scenario(text, "wall.toml");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

void expect_message(const std::string& text, std::initializer_list<const char*> words) {
  const auto message = refusal(text);
  EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  for (const auto* word : words) EXPECT_NE(message.find(word), std::string::npos) << "'" << word << "' in: " << message;
}

const models::ArmParameters& arm_of(const models::Scenario& scenario, Axis axis) {
  return scenario.arm.axes[static_cast<std::size_t>(axis)];
}

TEST(Scenario, OfAnEmptyFileIsTheDefault) {
  const auto scenario = parse_scenario("", "wall.toml");
  EXPECT_EQ(scenario.loop.stiffness_N_per_m, 400);
  for (const auto axis : models::kAxes) EXPECT_EQ(arm_of(scenario, axis), models::nominal_arm(axis));
  EXPECT_EQ(to_toml(scenario), to_toml(default_scenario()));
}

TEST(Scenario, FilesOfTheHouseAreRead) {
  const fs::path scenes = fs::path(HANDLOOP_SOURCE_DIR) / "scenes";
  EXPECT_EQ(read_scenario(scenes / "phantom_wall.toml").name, "phantom_wall");
  EXPECT_EQ(read_scenario(scenes / "phantom_wall.toml").device.model, models::DeviceModel::phantom_premium_1_5);
  EXPECT_EQ(read_scenario(scenes / "seven_bar.toml").device.model, models::DeviceModel::seven_bar);
}

TEST(Scenario, ComesBackToTheSameBytesWithEveryKeyChanged) {
  // Every key gets another value of its kind, so none can be lost on the way.
  std::string text, table;
  for (const auto& key : scenario_keys()) {
    if (key.table != table) text += "[" + (table = key.table) + "]\n";
    std::string value = key.initial;
    if (value == "true" || value == "false") {
      value = value == "true" ? "false" : "true";
    } else if (value.front() == '"') {
      const auto& words = key.values;
      const auto last = words.substr(words.rfind(' ') + 1);  // the last of the choices is never the default ...
      value = key.values == "text"
                  ? "\"another\""
                  : "\"" + (value == "\"" + last + "\"" ? words.substr(0, words.find(',')) : last) + "\"";
    } else if (value.front() == '[') {
      value = key.values.starts_with("3 ") ? "[0.1, -0.2, 0.3]" : "[0.1, -0.2, 0.3, 0.4]";
    } else if (value.find('.') == std::string::npos) {
      value = std::to_string(std::stoll(value) + 1);
    } else {
      const double number = std::stod(value);
      value = std::to_string(number == 0 ? 0.0625 : number * 0.75);
    }
    text += key.name + " = " + value + "\n";
  }
  const auto scenario = parse_scenario(text, "wall.toml");
  const auto written = to_toml(scenario);
  EXPECT_EQ(to_toml(parse_scenario(written, "again.toml")), written);
  const auto defaults = to_toml(default_scenario());
  for (const auto& key : scenario_keys()) {
    const auto line = "\n" + key.name + " = " + key.initial + "\n";
    const auto in_table = [&](const std::string& whole) {  // a key's name may stand in several tables
      const auto start = key.table.empty() ? 0 : whole.find("[" + key.table + "]");
      return ("\n" + whole.substr(start, whole.find("\n[", start + 1) - start) + "\n").find(line) != std::string::npos;
    };
    EXPECT_TRUE(in_table(defaults)) << key.table << "." << key.name;
    EXPECT_FALSE(in_table(written)) << key.table << "." << key.name << " was lost";
  }
}

TEST(Scenario, NamesArmsInFourWays) {
  const auto scenario = parse_scenario(R"([arm.x]
grip = "2"
[arm.y]
literature = "speich_y"
[arm.z]
mass_kg = 0.1
k1_N_per_m = 200
k2_N_per_m = 30.5
b1_Ns_per_m = 1
b2_Ns_per_m = 2
)",
                                       "wall.toml");
  EXPECT_EQ(arm_of(scenario, Axis::x), models::published_arm(Axis::x, models::Grip::two_N));
  EXPECT_EQ(arm_of(scenario, Axis::y), (models::ArmParameters{4.03, 108, 104, 9.20, 47.6}));  // Table V
  EXPECT_EQ(arm_of(scenario, Axis::z), (models::ArmParameters{0.1, 200, 30.5, 1, 2}));
}

TEST(Scenario, TakesAModelFileWithItsEffects) {
  const auto folder = fs::temp_directory_path() / ("handloop_scenario_" + std::to_string(::getpid()));
  fs::create_directories(folder);
  write_file_atomically(folder / "arm.toml", R"([arm]
axis = "x"
mass_kg = 0.2
k1_N_per_m = 300
k2_N_per_m = 80
b1_Ns_per_m = 1
b2_Ns_per_m = 4
[[effect]]
name = "coulomb_friction"
acts_on = "arm"
[effect.parameters]
force_N = 0.25
)");
  write_file_atomically(folder / "wall.toml", R"([arm.y]
model = "arm.toml"
[[arm.effect]]
axis = "z"
name = "cubic_stiffness"
)");
  const auto scenario = read_scenario(folder / "wall.toml");
  EXPECT_EQ(arm_of(scenario, Axis::y), (models::ArmParameters{0.2, 300, 80, 1, 4}));
  ASSERT_EQ(scenario.arm.effects.size(), 2U);
  EXPECT_EQ(scenario.arm.effects[0].first, Axis::y);
  EXPECT_EQ(scenario.arm.effects[0].second->parameter("force_N"), 0.25);
  EXPECT_EQ(scenario.arm.effects[1].first, Axis::z);
  EXPECT_EQ(scenario.arm.effects[1].second->info().name, "cubic_stiffness");
  const auto written = to_toml(scenario);
  EXPECT_EQ(to_toml(parse_scenario(written, "again.toml")), written);  // stands alone, without the model file
  fs::remove_all(folder);
}

TEST(Scenario, ArmWithoutAGraspIsHeldStiffly) {
  for (const auto& published : models::literature_arms()) {
    if (!published.rigid_grasp) continue;
    const auto scenario =
        parse_scenario("[arm.z]\nliterature = \"" + std::string(published.name) + "\"\n", "wall.toml");
    const auto& arm = arm_of(scenario, Axis::z);
    EXPECT_EQ(arm.mass_kg, published.arm.mass_kg);
    // The stiff grasp changes the compliance by little where the arm was measured.
    for (const double frequency_Hz : {1.0, 10.0, 30.0}) {
      const std::complex<double> s(0, 2 * 3.14159265358979 * frequency_Hz);
      const auto alone = 1.0 / (arm.mass_kg * s * s + arm.b2_Ns_per_m * s + arm.k2_N_per_m);
      EXPECT_LT(std::abs(models::compliance(arm, s) / alone - 1.0), 0.0101)
          << published.name;  // one percent by construction
    }
  }
}

TEST(Scenario, IsRefusedWithLineAndKey) {
  expect_message("stifness = 3\n", {"wall.toml", "line 1", "'stifness'", "did you mean 'stiffness_N_per_m' in [loop]"});
  expect_message("[loop]\nstiffness_N_m = 3\n", {"line 2", "[loop]", "did you mean 'stiffness_N_per_m'"});
  expect_message("[loop]\nstiffness = 3\n", {"line 2", "did you mean 'stiffness_N_per_m'"});
  expect_message("[lop]\nstiffness_N_per_m = 3\n", {"line 1", "table 'lop'", "did you mean 'loop'"});
  expect_message("[loop]\nstiffness_N_per_m = -3\n", {"line 2", "stiffness_N_per_m", "-3", "from 0"});
  expect_message("[loop]\nstiffness_N_per_m = \"3\"\n", {"line 2", "number", "text"});
  expect_message("[loop]\nstiffness_N_per_m = inf\n", {"line 2", "finite"});
  expect_message("[loop]\nsample_time_s = 0\n", {"line 2", "sample_time_s"});
  expect_message("[loop]\ndelay_samples = 1.5\n", {"line 2", "delay_samples", "whole"});
  expect_message("[electronics]\nideal = 1\n", {"line 2", "true or false"});
  expect_message("[device]\nmodel = \"phantom\"\n", {"line 2", "'phantom'", "phantom_premium_1_5"});
  expect_message("[device]\npose_rad = [0, 1]\n", {"line 2", "2 numbers", "3"});
  expect_message("[device]\npose_rad = [0, 1, 9]\n", {"line 2", "9", "3.2"});
  expect_message("device = 3\n", {"line 1", "table [device]"});
  expect_message("[wall]\naxis = \"q\"\n", {"line 2", "'q'"});
  expect_message("[arm.x]\n", {"line 1", "[arm.x]", "grip"});
  expect_message("[arm.x]\ngrip = \"7\"\n", {"line 2", "'7'", "nominal"});
  expect_message("[arm.x]\ngrip = \"1\"\nliterature = \"speich_x\"\n", {"[arm.x]", "several"});
  expect_message("[arm.x]\nliterature = \"speich_xx\"\n", {"line 2", "did you mean 'speich_x'"});
  expect_message("[arm.x]\nmass_kg = 1\n", {"[arm.x]", "lacks k1_N_per_m"});
  expect_message("[arm.x]\nmodel = \"nowhere.toml\"\n", {"nowhere.toml", "cannot be read"});
  expect_message("[arm.q]\ngrip = \"1\"\n", {"line 1", "'q'"});
  expect_message("[[arm.effect]]\nname = \"tremor\"\n", {"line 1", "lacks axis"});
  expect_message("[[arm.effect]]\naxis = \"x\"\nname = \"tremors\"\n", {"line 3", "did you mean 'tremor'"});
  expect_message("[arm\naxis=1", {"wall.toml", "line 1", "TOML"});
}

TEST(Scenario, EveryKeyIsDocumented) {
  const auto path = fs::path(HANDLOOP_SOURCE_DIR) / "docs" / "scenarios.md";
  const std::string begin = "from io/scenario_schema.h -->\n", end = "<!-- end of keys -->";
  auto text = read_file(path);
  const auto from = text.find(begin) + begin.size();
  const auto to = text.find(end);
  ASSERT_LE(from, to);
  if (std::getenv("HANDLOOP_UPDATE_DOCS") != nullptr) {
    write_file_atomically(path, text.replace(from, to - from, "\n" + scenario_keys_markdown()));
  } else {
    EXPECT_EQ(text.substr(from, to - from), "\n" + scenario_keys_markdown())
        << "docs/scenarios.md is out of date: run this test with HANDLOOP_UPDATE_DOCS=1";
  }
}

}  // namespace
}  // namespace handloop::io
