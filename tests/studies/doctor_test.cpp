#include "studies/doctor.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#ifdef __SANITIZE_ADDRESS__
#include <sanitizer/lsan_interface.h>
#endif

namespace handloop::studies {
namespace {

char graded(std::int64_t latest_ns, std::uint64_t missed, bool permitted) {
  device::LatencyHistogram wake;
  for (int i = 0; i < 9999; ++i) wake.add(5'000);
  wake.add(latest_ns);
  device::Schedule timing;
  timing.missed = missed;
  device::RealtimeGrant grant;
  if (!permitted) grant.refused.push_back("SCHED_FIFO");
  std::vector<std::string> reasons;
  const char mark = grade(wake, timing, grant, reasons);
  EXPECT_EQ(reasons.empty(), mark == 'A');
  return mark;
}

TEST(Doctor, GradesByTheWorstWakeUpAndByWhatWasMissed) {
  EXPECT_EQ(graded(20'000, 0, true), 'A');
  EXPECT_EQ(graded(20'000, 0, false), 'B');
  EXPECT_EQ(graded(150'000, 0, true), 'B');
  EXPECT_EQ(graded(900'000, 0, true), 'C');
  EXPECT_EQ(graded(900'000, 3, true), 'D');
  EXPECT_EQ(graded(900'000, 300, true), 'E');
}

TEST(Doctor, MeasuresThisMachine) {
#ifdef __SANITIZE_ADDRESS__
  const __lsan::ScopedDisabler graphics_driver;  // loaded, asked for its name and unloaded: it leaves 128 bytes behind
#endif
  const auto diagnosis = diagnose(0.3);
  EXPECT_GT(diagnosis.wake.count() + diagnosis.timing.missed, 250u);
  EXPECT_GT(diagnosis.sim_steps_per_s, 100.0);
  EXPECT_FALSE(diagnosis.kernel.empty());
  EXPECT_TRUE(diagnosis.opengl.empty() != diagnosis.opengl_problem.empty());
  const auto json = nlohmann::json::parse(diagnosis_json(diagnosis));
  EXPECT_EQ(json["grade"].get<std::string>().size(), 1u);
}

}  // namespace
}  // namespace handloop::studies
