#include "studies/proportions.h"

#include <gtest/gtest.h>

namespace handloop::studies {
namespace {

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
