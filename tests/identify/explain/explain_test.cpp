#include "identify/explain/explain.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/planted_recording.h"

/// The quick part of the planted-effect exam; the whole is bench/exam.
namespace handloop::identify {
namespace {

struct Exam {
  tests::PlantedRecording planted;
  Explanation explanation;

  bool named(const std::string& name) const {
    return std::any_of(explanation.effects.begin(), explanation.effects.end(),
                       [&](const auto& e) { return e.name == name; });
  }
  bool named_or_indistinguishable(const std::string& name) const {
    return named(name) || std::any_of(explanation.rivals.begin(), explanation.rivals.end(),
                                      [&](const auto& rival) { return rival.name == name && rival.indistinguishable; });
  }
  double over_floor() const { return explanation.after.errors.rmse_validation / planted.rmse_floor; }
};

Exam sit(const std::string& what, std::uint64_t seed) {
  Exam exam{tests::plant_recording(what, seed, {.duration_s = 30.0}), {}};
  models::Recording recording;
  recording.name = what;
  recording.force_N = exam.planted.force;
  recording.position_m = exam.planted.position;
  recording.sample_time_s = exam.planted.sample_time_s;
  ExplainOptions options;
  options.driven_by = exam.planted.driven_by == "force" ? DrivenBy::force : DrivenBy::position;
  options.base = exam.planted.base == "arm5" ? models::BaseModel::arm5 : models::BaseModel::msd;
  exam.explanation = explain(recording, std::nullopt, options);
  return exam;
}

TEST(Explain, FindsNothingInACleanRecording) {
  const auto exam = sit("none", 5);
  EXPECT_EQ(exam.explanation.verdict, Verdict::no_effect);
  EXPECT_LT(exam.over_floor(), 1.15);
}

class SingleEffect : public testing::TestWithParam<std::string> {};

TEST_P(SingleEffect, IsNamedAndPredictsAsWellAsTheTruth) {
  const auto exam = sit(GetParam(), 3);
  EXPECT_TRUE(exam.named_or_indistinguishable(GetParam())) << "found " << exam.explanation.after.effect_names();
  EXPECT_LT(exam.over_floor(), 1.15);
  EXPECT_LT(exam.explanation.after.errors.rmse_validation, exam.explanation.base.errors.rmse_validation);
}

INSTANTIATE_TEST_SUITE_P(Planted, SingleEffect, testing::Values("coulomb_friction", "cubic_stiffness", "added_mass"),
                         [](const auto& tested) { return tested.param; });

}  // namespace
}  // namespace handloop::identify
