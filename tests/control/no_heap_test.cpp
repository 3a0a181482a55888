#include <gtest/gtest.h>

#include <vector>

#include "control/closed_loop_verdict.h"
#include "control/margins.h"
#include "models/arm_tables.h"
#include "tests/heap_counter/heap_counter.h"

namespace handloop::control {
namespace {

using test::heap_allocations_of;

TEST(NoHeap, TheCounterCounts) {
  EXPECT_GE(heap_allocations_of([] { std::vector<int>(100).at(5) = 1; }), 1u);
}

TEST(NoHeap, IsUsedByAFullEvaluation) {
  for (const auto axis : models::kAxes) {
    for (const int delay : {0, 1, 3, 7}) {  // by polynomials, and by search
      Loop loop;
      loop.plant.arm = models::nominal_arm(axis);
      loop.timing.delay_samples = delay;
      loop.gains = {150, 0.5};
      Margins m;
      EXPECT_EQ(heap_allocations_of([&] { m = evaluate(loop); }), 0u) << delay;
      EXPECT_TRUE(m.stable);
    }
  }
}

TEST(NoHeap, IsUsedByAVerdictOrAPole) {
  const SampledPlant plant = sample_plant({0.075, 0.05, models::nominal_arm(models::Axis::z)}, 1e-3);
  const ClosedLoopVerdict verdict(plant, {});
  bool stable = false;
  EXPECT_EQ(heap_allocations_of([&] {
              stable = verdict.stable({400, 1}) && closed_loop_poles(plant, {}, {400, 1}).rho() < 1;
            }),
            0u);
  EXPECT_TRUE(stable);
}

}  // namespace
}  // namespace handloop::control
