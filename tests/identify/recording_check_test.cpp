#include "identify/recording_check.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "models/errors.h"
#include "tests/support/arm_recording.h"

namespace handloop::identify {
namespace {

models::Recording good_recording() {
  test::RecordingPlan plan;
  plan.arm = {0.2179, 379.5, 78.75, 1.839, 4.645};
  plan.duration_s = 20;
  const auto r = test::record_arm(plan);
  models::Recording out;
  out.name = "hand.csv";
  out.force_N = r.force_N;
  out.position_m = r.position_m;
  return out;
}

std::string refusal(const models::Recording& recording) {
  try {
    check_recording(recording);
    return "";
  } catch (const InputError& error) {
    return error.what();
  }
}

TEST(RecordingCheck, HasNothingToSayAboutAGoodRecording) {
  EXPECT_TRUE(check_recording(good_recording()).empty());
}

TEST(RecordingCheck, NamesTheFileAndWhatIsWrong) {
  auto r = good_recording();
  std::fill(r.position_m.begin(), r.position_m.end(), 0.01);
  EXPECT_NE(refusal(r).find("hand.csv: the position is constant"), std::string::npos);
  r = good_recording();
  r.force_N[99] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(refusal(r).find("sample 100"), std::string::npos);
  r = good_recording();
  std::swap(r.force_N, r.position_m);
  EXPECT_NE(refusal(r).find("exchanged"), std::string::npos);
  r = good_recording();
  for (auto& x : r.position_m) x *= 1000;
  EXPECT_NE(refusal(r).find("millimetres"), std::string::npos);
  r = good_recording();
  r.position_m.pop_back();
  EXPECT_NE(refusal(r).find("same number"), std::string::npos);
}

TEST(RecordingCheck, DoubtsALimitedOrStuckChannel) {
  auto r = good_recording();
  for (auto& f : r.force_N) f = std::min(f, 1.0);
  auto doubts = check_recording(r);
  ASSERT_EQ(doubts.size(), 1u);
  EXPECT_NE(doubts[0].find("extreme 1 in"), std::string::npos);
  r = good_recording();
  std::fill(r.position_m.begin() + 5000, r.position_m.begin() + 8000, r.position_m[5000]);
  doubts = check_recording(r);
  ASSERT_EQ(doubts.size(), 1u);
  EXPECT_NE(doubts[0].find("3 s from t = 5.000 s"), std::string::npos);
}

}  // namespace
}  // namespace handloop::identify
