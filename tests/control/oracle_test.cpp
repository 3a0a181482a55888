#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>

#include "control/margins.h"

/// The loop of docs/stability.md against figures computed elsewhere (python-control and SciPy in extended precision,
/// and Jury's test by bisection with 30 digits).
namespace handloop::control {
namespace {

std::vector<std::map<std::string, std::string>> read_table(const std::filesystem::path& path) {
  std::ifstream in(path);
  std::vector<std::map<std::string, std::string>> rows;
  std::vector<std::string> names;
  for (std::string line; std::getline(in, line);) {
    std::vector<std::string> fields;
    std::stringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');) fields.push_back(cell);
    if (names.empty()) {
      names = fields;
      continue;
    }
    auto& row = rows.emplace_back();
    for (std::size_t i = 0; i < names.size(); ++i) row[names[i]] = fields[i];
  }
  return rows;
}

double relative(double a, double b) {
  return a == b ? 0 : std::abs(a - b) / std::max(std::abs(b), 1e-12);
}

TEST(Oracle, EveryMarginOfEveryLoopAgrees) {
  const auto path = std::filesystem::path(HANDLOOP_SOURCE_DIR) / "../shared/oracle/margins.csv";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "no " << path;
  double worst = 0;
  for (auto& row : read_table(path)) {
    const auto of = [&row](const char* key) { return std::stod(row[key]); };
    Loop loop;
    loop.plant.arm = models::ArmParameters{of("M"), of("k1"), of("k2"), of("b1"), of("b2")};
    loop.gains = {of("K"), of("B")};
    const Margins m = evaluate(loop);
    ASSERT_EQ(m.stable, row["stable"] == "1") << row["id"];
    EXPECT_LT(relative(m.rho, of("rho")), 1e-12) << row["id"];
    if (!m.stable) continue;
    const std::pair<const char*, double> figures[] = {{"gm_up", m.gain_up},
                                                      {"gm_down", m.gain_down},
                                                      {"pm_deg", m.phase_deg},
                                                      {"dm_s", m.delay_s},
                                                      {"sm", m.modulus},
                                                      {"disk_alpha", m.disk_alpha},
                                                      {"w_gm_up", m.gain_up_at_rad_per_s},
                                                      {"w_pm", m.phase_at_rad_per_s}};
    for (const auto& [key, value] : figures) {
      const double expected = of(key);
      if (std::isnan(expected)) {
        EXPECT_TRUE(std::isnan(value)) << row["id"] << ' ' << key;
        continue;
      }
      EXPECT_LT(relative(value, expected), 1e-6) << row["id"] << ' ' << key << ' ' << value << ' ' << expected;
      worst = std::max(worst, relative(value, expected));
    }
  }
  RecordProperty("worst_relative", std::to_string(worst));
  if (std::getenv("HANDLOOP_RESIDUALS")) std::printf("worst relative difference %.2g\n", worst);
}

}  // namespace
}  // namespace handloop::control
