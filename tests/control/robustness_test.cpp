#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "control/passivity.h"
#include "control/population_margins.h"
#include "control/unstructured.h"
#include "models/arm_tables.h"

namespace handloop::control {
namespace {

TEST(Unstructured, PeaksMatchTheReference) {
  const auto path = std::filesystem::path(HANDLOOP_SOURCE_DIR) / "../shared/oracle/robust.csv";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "no " << path;
  std::ifstream in(path);
  std::string line;
  std::getline(in, line);
  int rows = 0;
  while (std::getline(in, line)) {
    std::vector<std::string> f;
    std::stringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');) f.push_back(cell);
    const auto axis = models::parse_axis(f[1]);
    const auto& W = models::uncertainty(axis, models::parse_uncertainty_set(f[2]));
    const LoopPlant plant{0.075, 0.05, models::nominal_arm(axis)};
    const WallGains gains{std::stod(f[3]), std::stod(f[4])};
    const auto narrow = unstructured_peak(plant, {}, gains, W, 0.6, 30),
               wide = unstructured_peak(plant, {}, gains, W, 0.01, 400);
    // the reference is a refined grid search; largest difference seen 2e-13
    EXPECT_NEAR(narrow.peak / std::stod(f[7]), 1, 1e-9) << line;
    EXPECT_NEAR(wide.peak / std::stod(f[9]), 1, 1e-9) << line;
    ++rows;
  }
  EXPECT_GT(rows, 20);
}

TEST(Passivity, ColgateAndSchenkelsWallNeedsHalfASampleOfStiffnessAndAllOfTheDamping) {
  const double kNoFilter = std::numeric_limits<double>::infinity();
  for (const double K : {10.0, 800.0}) {
    for (const double B : {0.0, 0.3, 4.0}) {
      // b > K T/2 + |B| for K + B (z-1)/(T z)
      EXPECT_NEAR(colgate_required_damping({0.001, 0, kNoFilter}, {K, B}), K * 0.0005 + B, 1e-9);
      EXPECT_NEAR(colgate_required_damping({0.001, 0, kNoFilter}, {K, -B}), K * 0.0005 + B, 1e-9);
    }
    for (const int d : {1, 2, 5}) {
      // delay alone adds d samples: b > K (T/2 + d T)
      EXPECT_NEAR(colgate_required_damping({0.001, d, kNoFilter}, {K, 0}), K * 0.001 * (0.5 + d), 1e-9);
      EXPECT_NEAR(colgate_permitted_stiffness({0.001, d, 100}, 0, 0.05), 0.05 / (0.001 * (0.5 + d)), 1e-6);
    }
  }
}

TEST(Passivity, AFreePhantomIsPassiveOnlyForTenNewtonsAMetre) {
  // b = 0.005 N s/m, f_c = 0.04 N, Delta = 0.03 mm, T = 1 ms
  const auto limits = abbott_okamura({0.001, 0, 100}, 0.005, 0.04, 3e-5);
  EXPECT_NEAR(limits.by_damping, 10, 1e-9);
  EXPECT_NEAR(limits.by_friction, 2666.67, 0.01);
  EXPECT_NEAR(limits.permitted(), 10, 1e-9);
  const auto d = diolaiti({0.001, 0, 100}, 1000, 0.005, 0.04, 3e-5);
  EXPECT_FALSE(d.damping_suffices);
  EXPECT_TRUE(d.friction_suffices);
}

/// The two-port closed by passive ends must be stable: an end that is a spring, a mass or a damper is one of them.
TEST(Passivity, AbsolutelyStableWallsAreStableInEveryPassiveHand) {
  const LoopTiming timing{0.001, 1, 100};
  const double b = 0.3;
  const double K = llewellyn_permitted_stiffness(timing, 0.02, b);
  // at low frequency 2 b B/K^2 >= (1/2 + d)^2 T^2/2; and never more than Colgate and Schenkel allow
  EXPECT_LE(K, 2 * std::sqrt(b * 0.02) / 0.0015 * (1 + 1e-6));
  EXPECT_LT(K, colgate_permitted_stiffness(timing, 0.02, b));
  ASSERT_GT(K, 20);
  for (const double k : {1.0, 100.0, 1e5}) {
    for (const double damping : {1e-4, 1.0, 50.0}) {
      for (const double mass : {1e-3, 0.1, 10.0}) {
        const Loop loop{
            {0.075, b, models::ArmParameters{mass, k, 0.3 * k, damping, damping}}, timing, {0.999 * K, 0.02}};
        EXPECT_TRUE(evaluate(loop).stable) << k << ' ' << damping << ' ' << mass;
      }
    }
  }
}

TEST(ClopperPearson, MeetsPublishedIntervals) {
  // Newcombe (1998), Statistics in Medicine 17:857, Table I: 81/263, 15/148, 0/20, 1/29
  const struct {
    std::uint64_t k, n;
    double low, high;
  } cases[] = {{81, 263, 0.2527, 0.3676}, {15, 148, 0.0578, 0.1617}, {0, 20, 0.0, 0.1684}, {1, 29, 0.0009, 0.1776}};
  for (const auto& c : cases) {
    const Share interval = clopper_pearson(c.k, c.n);
    EXPECT_NEAR(interval.low95, c.low, 6e-5);  // printed to four digits
    EXPECT_NEAR(interval.high95, c.high, 6e-5);
  }
}

TEST(ClopperPearson, NeverLeavesZeroToOneAndClosesInAsTrialsGrow) {
  EXPECT_EQ(clopper_pearson(0, 5).low95, 0);
  EXPECT_EQ(clopper_pearson(5, 5).high95, 1);
  const Share few = clopper_pearson(95, 100), many = clopper_pearson(9500, 10000);
  EXPECT_LT(many.high95 - many.low95, 0.2 * (few.high95 - few.low95));
}

TEST(Population, ClopperPearsonIsThePublishedInterval) {
  // Clopper and Pearson's own chart and any table of exact limits: 0 of 10 -> 0 to 0.3085, 5 of 10 -> 0.1871 to 0.8129
  EXPECT_NEAR(clopper_pearson(0, 10).high95, 0.3085, 5e-5);
  EXPECT_EQ(clopper_pearson(0, 10).low95, 0);
  EXPECT_NEAR(clopper_pearson(5, 10).low95, 0.1871, 5e-5);
  EXPECT_NEAR(clopper_pearson(5, 10).high95, 0.8129, 5e-5);
  EXPECT_EQ(clopper_pearson(10, 10).high95, 1);
}

TEST(Population, IsTheSameForAnyNumberOfThreads) {
  const models::ArmPopulation population(models::Axis::z);
  const Loop loop{{0.075, 0.05, {}}, {}, {1300, 2}};
  const auto one = population_margins(population, loop, 500, 3, 5, 1),
             four = population_margins(population, loop, 500, 3, 5, 4);
  EXPECT_EQ(one.stable.successes, four.stable.successes);
  EXPECT_EQ(one.disk_alpha, four.disk_alpha);
  ASSERT_EQ(one.worst.size(), four.worst.size());
  for (std::size_t i = 0; i < one.worst.size(); ++i) EXPECT_EQ(one.worst[i].index, four.worst[i].index);
  EXPECT_GT(one.stable.estimate, 0.2);
  EXPECT_LT(one.stable.estimate, 1.0);
  // worst first
  EXPECT_FALSE(one.worst.front().margins.stable);
}

TEST(Population, ShareStableAtThePermittedStiffnessIsTheShareAskedFor) {
  const models::ArmPopulation population(models::Axis::z);
  Loop loop{{0.075, 0.05, {}}, {}, {0, 2}};
  loop.gains.stiffness_N_per_m = 0.9999 * population_permitted_stiffness(population, loop, 1000, 5, 0.9);
  EXPECT_NEAR(population_margins(population, loop, 1000, 5).stable.estimate, 0.9, 0.0025);
}

}  // namespace
}  // namespace handloop::control
