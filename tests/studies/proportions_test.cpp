#include "studies/proportions.h"

#include <gtest/gtest.h>

namespace handloop::studies {
namespace {

TEST(ClopperPearson, MeetsPublishedIntervals) {
  // Newcombe (1998), Statistics in Medicine 17:857, Table I: 81/263, 15/148, 0/20, 1/29
  const struct {
    std::uint64_t k, n;
    double low, high;
  } cases[] = {{81, 263, 0.2527, 0.3676}, {15, 148, 0.0578, 0.1617}, {0, 20, 0.0, 0.1684}, {1, 29, 0.0009, 0.1776}};
  for (const auto& c : cases) {
    const ProportionInterval interval = clopper_pearson(c.k, c.n);
    EXPECT_NEAR(interval.low, c.low, 6e-5);  // printed to four digits
    EXPECT_NEAR(interval.high, c.high, 6e-5);
  }
}

TEST(ClopperPearson, NeverLeavesZeroToOneAndClosesInAsTrialsGrow) {
  EXPECT_EQ(clopper_pearson(0, 5).low, 0);
  EXPECT_EQ(clopper_pearson(5, 5).high, 1);
  const ProportionInterval few = clopper_pearson(95, 100), many = clopper_pearson(9500, 10000);
  EXPECT_LT(many.high - many.low, 0.2 * (few.high - few.low));
}

TEST(McNemar, CountsOnlyWhatChanged) {
  EXPECT_EQ(mcnemar_p_value(0, 0), 1);
  EXPECT_NEAR(mcnemar_p_value(1, 9), 2 * 11.0 / 1024, 1e-12);  // 2 (1 + 10) / 2^10
  EXPECT_EQ(mcnemar_p_value(5, 5), 1);
}

TEST(Fisher, MeetsTheLadyTastingTea) {
  EXPECT_NEAR(fisher_p_value(3, 4, 1, 4), 34.0 / 70, 1e-9);  // 2 (16 + 1) / 70
  EXPECT_NEAR(fisher_p_value(10, 100, 10, 100), 1, 1e-9);
}

}  // namespace
}  // namespace handloop::studies
