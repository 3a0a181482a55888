#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/support/program.h"

namespace handloop {
namespace {

class DemoCommand : public testing::Test {
 protected:
  void SetUp() override {
    std::string name = testing::TempDir() + "demo_command_XXXXXX";
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    directory = name;
  }
  void TearDown() override { std::filesystem::remove_all(directory); }
  std::string text_of(const std::string& name) const {
    std::ostringstream text;
    text << std::ifstream(directory / name).rdbuf();
    return text.str();
  }
  test::ProgramRun run(const std::string& out) const {
    return test::run_program(HANDLOOP_PROGRAM, {"demo", "--arms", "200", "--out", directory / out});
  }
  std::filesystem::path directory;
};

TEST_F(DemoCommand, LeavesAPageAndItsDataAndTheSameTwice) {
  const auto first = run("a");
  ASSERT_EQ(first.exit_code, 0) << first.err;
  EXPECT_TRUE(first.err.empty()) << first.err;
  const auto page = text_of("a/report.html");
  EXPECT_NE(page.find("<svg"), std::string::npos);
  EXPECT_EQ(page.find("src=\"http"), std::string::npos);

  ASSERT_EQ(run("b").exit_code, 0);
  for (const std::string name : {"/report.html", "/summary.json", "/closed_loop.csv"}) {
    EXPECT_EQ(text_of("a" + name), text_of("b" + name)) << name;
  }
}

// The margins say where the loop becomes unstable, the simulation does it: the default wall runs through, a spring 20 %
// beyond the predicted limit is stopped by the safety envelope.
TEST_F(DemoCommand, SimulationAndMarginsAgreeOnWhatIsStable) {
  ASSERT_EQ(run("demo").exit_code, 0);
  const auto json = nlohmann::json::parse(text_of("demo/summary.json"));
  EXPECT_TRUE(json["margins"]["z"]["nominal"]["stable"].get<bool>());
  EXPECT_EQ(json["run"]["fault"], "");
  EXPECT_NE(json["beyond"]["fault"], "");
  EXPECT_NEAR(json["beyond"]["stiffness_N_per_m"].get<double>(),
              1.2 * json["margins"]["z"]["critical_stiffness_N_per_m"].get<double>(), 1e-6);
}

}  // namespace
}  // namespace handloop
