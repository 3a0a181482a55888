#include <gtest/gtest.h>

#include <cstddef>

#include "tests/sim/plant_loop.h"

/// A step of the plant must not allocate, MuJoCo's part included. glibc's allocator is interposed for the whole test
/// program; sanitizers bring their own, so under them there is nothing to count.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__) || !defined(__GLIBC__)
#define HANDLOOP_COUNTS_ALLOCATIONS 0
#else
#define HANDLOOP_COUNTS_ALLOCATIONS 1
#endif

namespace {
thread_local std::size_t allocations = 0;
}

#if HANDLOOP_COUNTS_ALLOCATIONS
extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);

void* malloc(std::size_t size) {
  ++allocations;
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
  ++allocations;
  return __libc_calloc(count, size);
}
void* realloc(void* memory, std::size_t size) {
  ++allocations;
  return __libc_realloc(memory, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  ++allocations;
  return __libc_memalign(alignment, size);
}
}
#endif

namespace handloop::sim {
namespace {

using namespace testing_support;
using models::Place;

std::size_t allocations_of_a_run(const models::Scenario& scenario) {
  PhantomPlant plant(scenario);
  PlantCommand command;
  command.dac_codes.fill(2100);
  plant.advance(command);
  const std::size_t before = allocations;
  for (int k = 0; k < 200; ++k) {
    command.dac_codes[k % 3] += 1;
    static_cast<void>(plant.read());
    plant.advance(command);
    static_cast<void>(plant.truth());
  }
  plant.reset();
  return allocations - before;
}

TEST(PlantAllocation, NothingAfterConstruction) {
  if (!HANDLOOP_COUNTS_ALLOCATIONS) GTEST_SKIP() << "the sanitizer has its own allocator";
  auto scenario = nominal_scenario();
  scenario.electronics.ideal = false;
  EXPECT_EQ(allocations_of_a_run(scenario), 0u);

  scenario.device.structural_frequency_Hz = 80;
  scenario.device.joint_coulomb_Nm = 0.008;
  scenario.arm.wander_rms_m = 0.001;
  scenario.hand.push_N = 1;
  scenario.hand.disturbance_N = 0.5;
  scenario.arm.force_sensed_at = models::ForceSensedAt::flange;
  for (const auto& type : models::effect_catalogue()) {
    for (const auto place : type.info.places) {
      scenario.arm.effects.emplace_back(models::Axis::y, models::make_typical_effect(type.info.name, place));
    }
  }
  EXPECT_EQ(allocations_of_a_run(scenario), 0u);
}

TEST(PlantAllocation, CountsWhatIsAllocated) {
  if (!HANDLOOP_COUNTS_ALLOCATIONS) GTEST_SKIP() << "the sanitizer has its own allocator";
  const std::size_t before = allocations;
  const PhantomPlant plant(nominal_scenario());
  EXPECT_GT(allocations - before, 10u);
}

}  // namespace
}  // namespace handloop::sim
