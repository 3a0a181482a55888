#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <new>

#include "control/closed_loop_verdict.h"
#include "control/margins.h"
#include "models/arm_tables.h"

namespace {
std::atomic<long> allocations{0};
}

// every allocation of this program passes here
void* operator new(std::size_t size) {
  ++allocations;
  if (void* memory = std::malloc(size)) return memory;
  throw std::bad_alloc();
}
void operator delete(void* memory) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}

namespace handloop::control {
namespace {

long allocations_of(auto&& work) {
  const long before = allocations;
  work();
  return allocations - before;
}

TEST(NoHeap, TheCounterCounts) {
  EXPECT_GE(allocations_of([] { delete new int(3); }), 0);  // may be elided
  EXPECT_GE(allocations_of([] { std::vector<int>(100).at(5) = 1; }), 1);
}

TEST(NoHeap, IsUsedByAFullEvaluation) {
  for (const auto axis : models::kAxes) {
    for (const int delay : {0, 1, 3, 7}) {  // by polynomials, and by search
      Loop loop;
      loop.plant.arm = models::nominal_arm(axis);
      loop.timing.delay_samples = delay;
      loop.gains = {150, 0.5};
      Margins m;
      EXPECT_EQ(allocations_of([&] { m = evaluate(loop); }), 0) << delay;
      EXPECT_TRUE(m.stable);
    }
  }
}

TEST(NoHeap, IsUsedByAVerdictOrAPole) {
  const SampledPlant plant = sample_plant({0.075, 0.05, models::nominal_arm(models::Axis::z)}, 1e-3);
  const ClosedLoopVerdict verdict(plant, {});
  bool stable = false;
  EXPECT_EQ(allocations_of([&] {
              stable = verdict.stable({400, 1}) && closed_loop_poles(plant, {}, {400, 1}).rho() < 1;
            }),
            0);
  EXPECT_TRUE(stable);
}

}  // namespace
}  // namespace handloop::control
