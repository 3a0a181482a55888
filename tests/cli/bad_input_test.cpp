#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "tests/support/program.h"

/// Whatever a person gives, the program says in one line what was wrong, ends with 2 and leaves nothing behind.
namespace handloop {
namespace {
namespace fs = std::filesystem;

using Words = std::vector<std::string>;

std::string recording(int rows, const std::string& header = "time_s,force_N,position_m\n") {
  std::string text = header;
  char line[96];
  for (int i = 0; i < rows; ++i) {
    std::snprintf(line, sizeof line, "%.3f,%.4f,%.6f\n", i * 0.001, std::sin(i / 20.0),
                  0.01 * std::sin(i / 20.0 - 0.5));
    text += line;
  }
  return text;
}

std::string arm(const std::string& mass, const std::string& more = "") {
  return "[arm]\naxis=\"x\"\nmass_kg=" + mass + "\nk1_N_per_m=300\nk2_N_per_m=80\nb1_Ns_per_m=1\nb2_Ns_per_m=4\n" +
         more;
}

class BadInput : public testing::Test {
 protected:
  fs::path folder = fs::temp_directory_path() / ("handloop_bad_input_" + std::to_string(::getpid()));
  void SetUp() override { fs::create_directories(folder); }
  void TearDown() override { fs::remove_all(folder); }

  std::string file(const std::string& name, const std::string& text) const {
    std::ofstream(folder / name, std::ios::binary) << text;
    return (folder / name).string();
  }
  std::string path(const std::string& name) const { return (folder / name).string(); }

  /// Exit code 2, one line (three at most) that holds the words, no output.
  void expect_refused(const Words& words, const std::vector<std::string>& expected) const {
    const auto commands = test::run_program(HANDLOOP_PROGRAM, {"complete-words", ""}).out;
    if ((" " + commands).find(" " + words.front() + " ") == std::string::npos) return;  // not there yet
    const auto before = entries();
    const auto run = test::run_program(HANDLOOP_PROGRAM, words, HANDLOOP_SOURCE_DIR);
    std::string typed;
    for (const auto& word : words) typed += word + " ";
    EXPECT_EQ(run.exit_code, 2) << typed << "\n" << run.err;
    const auto lines = std::count(run.err.begin(), run.err.end(), '\n');
    EXPECT_TRUE(lines >= 1 && lines <= 3) << typed << "\n" << run.err;
    for (const auto& word : expected) {
      EXPECT_NE(run.err.find(word), std::string::npos) << typed << "\n'" << word << "' in: " << run.err;
    }
    EXPECT_EQ(entries(), before) << typed << "left something behind";
  }

  Words entries() const {
    Words names;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) names.push_back(entry.path().string());
    std::sort(names.begin(), names.end());
    return names;
  }
};

TEST_F(BadInput, RecordingsAreRefusedWithFileAndLine) {
  const auto good = recording(5000);
  const std::vector<std::pair<std::string, std::vector<std::string>>> cases{
      {path("missing.csv"), {"missing.csv", "cannot be read"}},
      {file("empty.csv", ""), {"empty.csv", "empty"}},
      {file("header.csv", "time_s,force_N,position_m\n"), {"header.csv", "no rows"}},
      {file("few.csv", recording(3)), {"few.csv", "3 rows"}},
      {file("nan.csv", good + "5.000,nan,0.1\n"), {"nan.csv", "line 5002", "force_N"}},
      {file("short.csv", good + "5.000,1\n"), {"short.csv", "line 5002", "2 cells"}},
      {file("text.csv", good + "5.000,abc,0.1\n"), {"text.csv", "line 5002", "'abc'"}},
      {file("gap.csv", good + "5.100,1,0.1\n"), {"gap.csv", "line 5002", "gap"}},
      {file("binary.csv", std::string("\x7f"
                                      "ELF\0\0\0",
                                      7)),
       {"binary.csv", "not text"}},
      {file("columns.csv", "a,b,c\n1,2,3\n"), {"columns.csv", "a, b, c"}},
      {file("text.mat", "nonsense"), {"text.mat", "version 5"}},
  };
  for (const auto& [recording_path, words] : cases) {
    expect_refused({"explain", recording_path, "--out", path("out")}, words);
    expect_refused({"identify", recording_path, "--out", path("out")}, words);
  }
  expect_refused({"explain", folder.string(), "--out", path("out")}, {"is a directory"});
  // A directory stands for its recordings; the first bad one is named, and so is one that holds none.
  expect_refused({"identify", folder.string(), "--out", path("out")}, {"binary.csv", "not text"});
  fs::create_directory(folder / "none");
  expect_refused({"identify", path("none"), "--out", path("out")}, {"none", "no .csv or .mat recordings"});
  expect_refused({"explain", file("good.csv", good), "--force", "forc_N", "--out", path("out")},
                 {"did you mean 'force_N'"});
  expect_refused({"explain", path("good.csv"), "--rate", "-3", "--out", path("out")}, {"--rate"});
}

TEST_F(BadInput, ModelFilesAreRefusedWithLineAndKey) {
  const auto refuse = [&](const std::string& text, const std::vector<std::string>& words) {
    const auto model = file("model.toml", text);
    for (const auto* command : {"experiment", "margins"}) {
      if (std::string(command) == "margins" &&
          test::run_program(HANDLOOP_PROGRAM, {"margins", "--help"}).out.find("--arm ") == std::string::npos) {
        continue;
      }
      expect_refused({command, "--axis", "x", "--arm", model, "--out", path("out")}, words);
    }
  };
  refuse("[arm\naxis=1", {"model.toml", "line 1"});
  refuse(arm("-1"), {"model.toml", "line 3", "mass_kg"});
  refuse(arm("nan"), {"model.toml", "line 3", "mass_kg"});
  refuse(arm("0.2", "stiffness=3\n"), {"model.toml", "line 8", "stiffness"});
  refuse(arm("0.2", "[[effect]]\nname=\"coulom_friction\"\n"),
         {"model.toml", "line 9", "did you mean 'coulomb_friction'"});
  refuse(arm("0.2", "[[effect]]\nname=\"coulomb_friction\"\nacts_on=\"elbow\"\n"),
         {"model.toml", "line 10", "'elbow'"});
}

TEST_F(BadInput, ScenariosAreRefusedWithLineAndKey) {
  const auto refuse = [&](const std::string& text, const std::vector<std::string>& words) {
    const auto scenario = file("scenario.toml", text);
    expect_refused({"run", scenario, "--out", path("out")}, words);
    expect_refused({"sweep", scenario, "--arms", "10", "--out", path("out")}, words);
    expect_refused({"plant", scenario, "--listen", "127.0.0.1:0"}, words);
  };
  refuse("[arm\naxis=1", {"scenario.toml", "line 1"});
  refuse("stifness = 3\n", {"scenario.toml", "line 1", "did you mean 'stiffness_N_per_m' in [loop]"});
  refuse("[loop]\nsample_time_s = -1\n", {"scenario.toml", "line 2", "sample_time_s"});
  refuse("[arm.x]\nmodel = \"nowhere.toml\"\n", {"nowhere.toml"});
  expect_refused({"run", path("missing.toml"), "--out", path("out")}, {"missing.toml", "cannot be read"});
}

TEST_F(BadInput, PlacesThatCannotBeWrittenAreNamed) {
  expect_refused({"arm", "sample", "--axis", "x", "--count", "5", "--out", "/proc/none/z.csv"}, {"/proc/none/z.csv"});
  expect_refused({"arm", "show", "--axis", "x", "--json", folder.string()}, {"is a directory"});
  expect_refused({"run", "scenes/phantom_wall.toml", "--duration", "0.01", "--out", "/proc/none/out"},
                 {"/proc/none/out"});
  const auto taken = file("taken", "a file");
  expect_refused({"run", "scenes/phantom_wall.toml", "--duration", "0.01", "--out", taken}, {"taken"});
  expect_refused({"experiment", "--axis", "x", "--subjects", "1", "--grips", "1", "--out", taken}, {"taken"});
}

TEST_F(BadInput, ValuesThatMakeNoSenseAreRefused) {
  const auto wall = std::string("scenes/phantom_wall.toml");
  expect_refused({"arm", "show", "--axis", "x", "--grip", "7"}, {"'7'", "nominal"});
  expect_refused({"arm", "sample", "--axis", "x", "--count", "-5", "--seed", "1", "--out", path("z.csv")},
                 {"--count", "-5"});
  expect_refused({"margins", "--num", "1,x", "--den", "1,2", "--json", "-"}, {"--num", "'x'"});
  expect_refused({"margins", "--num", "1", "--den", "0", "--json", "-"}, {"den"});
  expect_refused({"margins", "--cases", file("cases.csv", "id,K\n1,2\n"), "--out", path("o.csv")}, {"cases.csv"});
  expect_refused({"run", wall, "--device", "floppy", "--out", path("out")}, {"floppy", "sim"});
  expect_refused({"run", wall, "--device", "replay:" + path("no.csv"), "--out", path("out")}, {"no.csv"});
  expect_refused({"run", wall, "--duration", "-1", "--out", path("out")}, {"duration"});
  expect_refused({"sweep", wall, "--arms", "10", "--gains", "k=5:1:0", "--out", path("out")}, {"gains"});
  expect_refused({"sweep", wall, "--arms", "-1", "--out", path("out")}, {"--arms"});
  expect_refused({"sweep", wall, "--arms", "10", "--require", "p_stble>=0.9", "--out", path("out")}, {"p_stble"});
  expect_refused({"experiment", "--axis", "x", "--grips", "9", "--out", path("out")}, {"9"});
  expect_refused({"identify", "--index", path("no.csv"), "--out", path("out")}, {"no.csv"});
}

}  // namespace
}  // namespace handloop
