#include "studies/arm_sampling.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <sstream>

#include "io/csv_file.h"
#include "models/errors.h"
#include "studies/arm_bode.h"

namespace handloop::studies {
namespace {

class ArmSampling : public testing::Test {
 protected:
  void SetUp() override {
    std::string name = testing::TempDir() + "arm_sampling_XXXXXX";
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    directory = name;
  }
  void TearDown() override { std::filesystem::remove_all(directory); }
  std::string text_of(const std::filesystem::path& path) const {
    std::ostringstream text;
    text << std::ifstream(path).rdbuf();
    return text.str();
  }
  std::filesystem::path file(const std::string& name, const std::string& text) const {
    std::ofstream(directory / name) << text;
    return directory / name;
  }
  std::filesystem::path directory;
};

TEST_F(ArmSampling, FileHoldsTheSampledArmsToTheLastBit) {
  const models::ArmPopulation population(models::Axis::y);
  write_arm_sample(population, 50, 9, directory / "arms.csv");
  const io::CsvFile csv(directory / "arms.csv");
  const std::vector<std::string> header{"axis", "mass_kg", "k1_N_per_m", "k2_N_per_m", "b1_Ns_per_m", "b2_Ns_per_m"};
  EXPECT_EQ(csv.columns(), header);
  std::size_t count = 0;
  csv.for_each_row([&](std::size_t row, std::span<const std::string> cells) {
    EXPECT_EQ(cells[0], "y");
    const auto arm = to_array(population.sample(9, row));
    for (std::size_t j = 0; j < 5; ++j) EXPECT_EQ(csv.to_number(cells[j + 1], row, j + 1), arm[j]);
    ++count;
  });
  EXPECT_EQ(count, 50u);
}

TEST_F(ArmSampling, ALongerSampleBeginsWithTheShorter) {
  const models::ArmPopulation population(models::Axis::z);
  write_arm_sample(population, 10, 3, directory / "short.csv");
  write_arm_sample(population, 1000, 3, directory / "long.csv");
  const auto shorter = text_of(directory / "short.csv");
  EXPECT_EQ(text_of(directory / "long.csv").substr(0, shorter.size()), shorter);
}

TEST_F(ArmSampling, SummaryNamesTheRowsThatCannotBeMet) {
  for (const auto axis : models::kAxes) {
    for (const auto& row : write_arm_sample(models::ArmPopulation(axis), 100'000, 1, directory / "arms.csv")) {
      EXPECT_LT(row.worst_deviation, 0.02) << row.worst_statistic;
      EXPECT_FALSE(row.gap);
    }
  }
  // Read as central intervals, mean, deviation and percentiles leave no room: every row of X needs a gap.
  const models::ArmPopulation central(models::Axis::x, models::PercentileReading::central);
  for (const auto& row : write_arm_sample(central, 1000, 1, directory / "arms.csv")) {
    EXPECT_TRUE(row.gap || !row.feasible);
  }
}

TEST_F(ArmSampling, NothingAppearsWhereTheFileCannotBeWritten) {
  EXPECT_THROW(write_arm_sample(models::ArmPopulation(models::Axis::x), 5, 1, "/proc/none/arms.csv"), InputError);
}

TEST_F(ArmSampling, ReadsACorrelationAndRefusesWhatIsNone) {
  const auto matrix = read_correlation(file("good.csv", "1,0.5,0,0,0\n0.5,1,0,0,0\n0,0,1,0,0\n0,0,0,1,0\n0,0,0,0,1\n"));
  EXPECT_EQ(matrix(0, 1), 0.5);
  EXPECT_EQ(matrix(2, 2), 1);
  EXPECT_THROW(read_correlation(file("narrow.csv", "1,0\n0,1\n")), InputError);
  EXPECT_THROW(read_correlation(file("short.csv", "1,0,0,0,0\n0,1,0,0,0\n")), InputError);
  EXPECT_THROW(read_correlation(directory / "missing.csv"), InputError);
}

TEST(ArmBode, MeetsTheStaticComplianceAndTheRigidLimit) {
  const models::ArmPopulation population(models::Axis::x);
  const auto bode = arm_bode(population, {200, 1, {"all"}});
  ASSERT_EQ(bode.published.size(), 4u);
  EXPECT_EQ(bode.literature.size(), 7u);
  // At 0.1 Hz the nominal arm is its two springs in series, 1/379.5 + 1/78.75 m/N = -36.3 dB (0.004 dB from the
  // dampers).
  EXPECT_NEAR(bode.published[3].magnitude_dB.front(), 20 * std::log10(1 / 379.5 + 1 / 78.75), 0.01);
  for (std::size_t i = 0; i < bode.frequency_Hz.size(); ++i) {
    EXPECT_LE(bode.magnitude_dB.p05[i], bode.magnitude_dB.p50[i]);
    EXPECT_LE(bode.magnitude_dB.p50[i], bode.magnitude_dB.p95[i]);
  }
}

// The paper's Figure 7: the nominal arm is the centre of the measured spread, so it lies within the sampled fan.
TEST(ArmBode, NominalArmLiesWithinTheFanOfSampledArms) {
  for (const auto axis : models::kAxes) {
    const auto bode = arm_bode(models::ArmPopulation(axis), {1000, 1, {}});
    for (std::size_t i = 0; i < bode.frequency_Hz.size(); ++i) {
      if (bode.frequency_Hz[i] < 0.6 || bode.frequency_Hz[i] > 30) continue;
      double low = 1e9, high = -1e9;
      for (const auto& c : bode.samples) {
        low = std::min(low, c.magnitude_dB[i]);
        high = std::max(high, c.magnitude_dB[i]);
      }
      EXPECT_GT(bode.published[3].magnitude_dB[i], low) << axis_name(axis) << bode.frequency_Hz[i];
      EXPECT_LT(bode.published[3].magnitude_dB[i], high) << axis_name(axis) << bode.frequency_Hz[i];
    }
  }
}

}  // namespace
}  // namespace handloop::studies
