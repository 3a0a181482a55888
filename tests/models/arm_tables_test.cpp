#include "models/arm_tables.h"

#include <gtest/gtest.h>

#include <cmath>

#include "models/errors.h"

namespace handloop::models {
namespace {

TEST(ArmTables, TableThreeIsInOrderInEveryRow) {
  for (const Axis axis : kAxes) {
    for (std::size_t i = 0; i < 5; ++i) {
      const auto& row = parameter_statistics(axis, i);
      EXPECT_LE(row.minimum, row.ci95_minimum);
      EXPECT_LT(row.ci95_minimum, row.ci67_minimum);
      EXPECT_LT(row.ci67_minimum, row.mean);
      EXPECT_LT(row.mean, row.ci67_maximum);
      EXPECT_LT(row.ci67_maximum, row.ci95_maximum);
      EXPECT_LT(row.ci95_maximum, row.maximum);
    }
  }
}

// The paper's discussion (IV-A) quotes ranges over all axes: a second printing of numbers in Table III.
TEST(ArmTables, RangesAgreeWithTheDiscussion) {
  double mass_low = 1e9, mass_high = 0, k1_low = 1e9, k1_high = 0, k2_low = 1e9, k2_high = 0;
  for (const Axis axis : kAxes) {
    mass_low = std::min(mass_low, parameter_statistics(axis, 0).minimum);
    mass_high = std::max(mass_high, parameter_statistics(axis, 0).maximum);
    k1_low = std::min(k1_low, parameter_statistics(axis, 1).minimum);
    k1_high = std::max(k1_high, parameter_statistics(axis, 1).maximum);
    k2_low = std::min(k2_low, parameter_statistics(axis, 2).minimum);
    k2_high = std::max(k2_high, parameter_statistics(axis, 2).maximum);
  }
  EXPECT_NEAR(mass_low, 0.0003, 1e-9);
  EXPECT_NEAR(mass_high, 0.91, 0.005);
  EXPECT_NEAR(k1_low, 141, 0.5);
  EXPECT_NEAR(k1_high, 1050, 0.5);
  EXPECT_NEAR(k2_low, 53, 0.5);
  EXPECT_NEAR(k2_high, 589, 0.5);
}

TEST(ArmTables, GripArmsAndNominalArmsLieWithinThePopulation) {
  for (const Axis axis : kAxes) {
    for (const Grip grip : {Grip::one_N, Grip::two_N, Grip::three_N, Grip::nominal}) {
      const auto arm = to_array(published_arm(axis, grip));
      for (std::size_t i = 0; i < 5; ++i) {
        EXPECT_GE(arm[i], 0.94 * parameter_statistics(axis, i).minimum)
            << kArmParameterNames[i];  // Y nominal b1: 3.609
        EXPECT_LE(arm[i], parameter_statistics(axis, i).maximum) << kArmParameterNames[i];
      }
    }
  }
}

TEST(ArmTables, KosugeIsASecondOrderArmWithoutGrasp) {
  const auto model = find_literature_arm("kosuge").model();
  EXPECT_EQ(model.base, BaseModel::msd);
  EXPECT_EQ(model.msd, (MsdParameters{11.6, 17.3, 243}));
}

TEST(ArmTables, EveryArmOfTableFiveIsAValidModel) {
  EXPECT_EQ(literature_arms().size(), 7u);
  for (const auto& row : literature_arms()) {
    EXPECT_NO_THROW(require_valid(row.model())) << row.name;
    EXPECT_EQ(&find_literature_arm(row.name), &row);
  }
}

TEST(ArmTables, UnknownWordsAreRefusedWithTheNearestKnown) {
  try {
    find_literature_arm("speich_w");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("speich_"), std::string::npos);
  }
  EXPECT_THROW(parse_grip("7"), InputError);
}

}  // namespace
}  // namespace handloop::models
