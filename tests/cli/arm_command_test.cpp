#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/support/program.h"

namespace handloop {
namespace {

using test::run_program;

test::ProgramRun handloop(const std::vector<std::string>& arguments) {
  return run_program(HANDLOOP_PROGRAM, arguments);
}

void expect_refusal(const std::vector<std::string>& arguments, const std::string& word) {
  const auto run = handloop(arguments);
  EXPECT_EQ(run.exit_code, 2) << run.err;
  EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
  EXPECT_NE(run.err.find(word), std::string::npos) << run.err;
}

class ArmCommand : public testing::Test {
 protected:
  void SetUp() override {
    std::string name = testing::TempDir() + "arm_command_XXXXXX";
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    directory = name;
  }
  void TearDown() override { std::filesystem::remove_all(directory); }
  std::string path(const std::string& name) const { return directory / name; }
  std::string text_of(const std::string& name) const {
    std::ostringstream text;
    text << std::ifstream(path(name)).rdbuf();
    return text.str();
  }
  std::filesystem::path directory;
};

TEST_F(ArmCommand, ShowsTableTwoAsJson) {
  const auto run = handloop({"arm", "show", "--axis", "Y", "--grip", "nominal", "--json", "-"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto json = nlohmann::json::parse(run.out);
  EXPECT_EQ(json["mass_kg"], 0.2692);
  EXPECT_EQ(json["k1_N_per_m"], 552.4);
  EXPECT_EQ(json["k2_N_per_m"], 105.3);
  EXPECT_EQ(json["b1_Ns_per_m"], 3.609);
  EXPECT_EQ(json["b2_Ns_per_m"], 6.430);
  EXPECT_EQ(json["poles"].size(), 3u);
  EXPECT_EQ(json["zeros"].size(), 2u);
}

TEST_F(ArmCommand, WritesAPublishedArmAsAModelFile) {
  ASSERT_EQ(handloop({"arm", "show", "--literature", "speich_y", "--model", path("arm.toml")}).exit_code, 0);
  EXPECT_NE(text_of("arm.toml").find("mass_kg = 4.03"), std::string::npos);
  EXPECT_NE(text_of("arm.toml").find("\"y\""), std::string::npos);
}

TEST_F(ArmCommand, SamplesTheSameBytesForTheSameSeed) {
  for (const std::string name : {"a.csv", "b.csv"}) {
    ASSERT_EQ(
        handloop({"arm", "sample", "--axis", "z", "--count", "500", "--seed", "4", "--out", path(name)}).exit_code, 0);
  }
  EXPECT_EQ(text_of("a.csv"), text_of("b.csv"));
  EXPECT_EQ(text_of("a.csv").substr(0, text_of("a.csv").find('\n')),
            "axis,mass_kg,k1_N_per_m,k2_N_per_m,b1_Ns_per_m,b2_Ns_per_m");
}

TEST_F(ArmCommand, BodeLeavesAPageThatNeedsNoNetwork) {
  const auto run =
      handloop({"arm", "bode", "--axis", "x", "--count", "20", "--literature", "all", "--out", path("bode")});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto page = text_of("bode/report.html");
  EXPECT_NE(page.find("<svg"), std::string::npos);
  EXPECT_EQ(page.find("src=\"http"), std::string::npos);
  EXPECT_EQ(page.find("href=\"http"), std::string::npos);
  // 4 published, 7 of Table V, 20 sampled arms at 241 frequencies, and the header.
  const auto csv = text_of("bode/bode.csv");
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 31 * 241 + 1);
}

TEST_F(ArmCommand, UncertaintyGivesThePeaksAndBothTables) {
  const auto run = handloop({"uncertainty", "--axis", "z", "--set", "67", "--json", "-"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto json = nlohmann::json::parse(run.out);
  EXPECT_NEAR(json["peak_dB"].get<double>(), -6.5, 0.1);
  EXPECT_NEAR(json["table_as_printed"]["peak_dB"].get<double>(), 32.6, 0.1);
  EXPECT_EQ(json["table_as_printed"]["pole_pairs"][4][1], 5.687);
  EXPECT_EQ(json["table_as_corrected"]["pole_pairs"][4][1], 95.687);
  EXPECT_EQ(json["frequency_Hz"].size(), json["magnitude_dB"].size());
  EXPECT_EQ(json["frequency_Hz"].front(), 0.6);
  EXPECT_EQ(json["frequency_Hz"].back(), 30);
}

TEST_F(ArmCommand, RefusesBadInputInOneHelpfulLine) {
  expect_refusal({"arm", "show", "--axis", "q", "--grip", "1"}, "x (left-right)");
  expect_refusal({"arm", "show", "--axis", "x", "--grip", "7"}, "nominal");
  expect_refusal({"arm", "show", "--literature", "speich_w"}, "speich_");
  expect_refusal({"arm", "show"}, "--axis");
  expect_refusal({"arm", "sample", "--axis", "x", "--count", "-5", "--out", path("z.csv")}, "--count");
  expect_refusal({"arm", "sample", "--axis", "x", "--count", "5", "--out", "/proc/none/z.csv"}, "/proc/none/z.csv");
  expect_refusal({"arm", "sample", "--axis", "x", "--count", "5", "--percentiles", "p", "--out", path("z.csv")},
                 "ecdf");
  expect_refusal({"uncertainty", "--axis", "z", "--set", "95"}, "67");
  EXPECT_TRUE(std::filesystem::is_empty(directory));
}

}  // namespace
}  // namespace handloop
