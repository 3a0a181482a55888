#include "identify/recording_check.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
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

TEST(RecordingCheck, NamesAGlitchByItsSampleAndARateTooLow) {
  models::Recording r;
  r.name = "hand";
  r.sample_time_s = 0.001;
  for (int n = 0; n < 20000; ++n) {
    r.force_N.push_back(std::sin(0.01 * n));
    r.position_m.push_back(0.002 * std::sin(0.01 * n - 0.3));
  }
  EXPECT_TRUE(check_recording(r).empty());
  const double whole = r.position_m[777];
  r.position_m[777] = 0.08;
  const auto doubts = check_recording(r);
  ASSERT_EQ(doubts.size(), 1u);
  EXPECT_NE(doubts[0].find("sample 778"), std::string::npos) << doubts[0];
  const auto refusal = [&]() -> std::string {
    try {
      check_recording(r);
      return "";
    } catch (const InputError& error) {
      return error.what();
    }
  };
  r.position_m[777] = 5;
  EXPECT_NE(refusal().find("sample 778"), std::string::npos) << refusal();
  r.position_m[777] = whole;
  r.sample_time_s = 1;
  EXPECT_NE(refusal().find("time_ms"), std::string::npos) << refusal();
}

}  // namespace
}  // namespace handloop::identify
