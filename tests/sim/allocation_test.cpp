#include <gtest/gtest.h>

#include <cstddef>

#include "tests/heap_counter/heap_counter.h"
#include "tests/sim/plant_loop.h"

/// A step of the plant must not allocate, MuJoCo's part included.
namespace handloop::sim {
namespace {

using namespace testing_support;
using models::Place;

std::size_t allocations_of_a_run(const models::Scenario& scenario) {
  PhantomPlant plant(scenario);
  PlantCommand command;
  command.dac_codes.fill(2100);
  plant.advance(command);
  return test::heap_allocations_of([&] {
    for (int k = 0; k < 200; ++k) {
      command.dac_codes[k % 3] += 1;
      static_cast<void>(plant.read());
      plant.advance(command);
      static_cast<void>(plant.truth());
    }
    plant.reset();
  });
}

TEST(PlantAllocation, NothingAfterConstruction) {
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
  EXPECT_GT(test::heap_allocations_of([] { const PhantomPlant plant(nominal_scenario()); }), 10u);
}

}  // namespace
}  // namespace handloop::sim
