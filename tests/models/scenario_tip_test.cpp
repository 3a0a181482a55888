#include "models/scenario_tip.h"

#include <gtest/gtest.h>

#include "models/errors.h"

namespace handloop::models {
namespace {

// At home the joints are uncoupled: x turns the base at l1, y lifts the upper link at l1, z swings the forearm at l2.
TEST(ScenarioTip, IsTheDeviceAndItsStylusAtHome) {
  const Scenario scenario;
  EXPECT_NEAR(tip_of(scenario, Axis::x).mass_kg, 0.052 + 35.7348e-4 / 0.215 / 0.215, 1e-6);
  EXPECT_NEAR(tip_of(scenario, Axis::y).mass_kg, 0.052 + 24.2640e-4 / 0.215 / 0.215, 1e-6);
  EXPECT_NEAR(tip_of(scenario, Axis::z).mass_kg, 0.052 + 9.3189e-4 / 0.170 / 0.170, 1e-6);
  EXPECT_NEAR(tip_of(scenario, Axis::y).damping_Ns_per_m, 0.0005 / 0.215 / 0.215, 1e-12);
  EXPECT_NEAR(tip_of(scenario, Axis::z).damping_Ns_per_m, 0.0005 / 0.170 / 0.170, 1e-12);
}

TEST(ScenarioTip, RefusesAStretchedElbow) {
  Scenario scenario;
  scenario.device.pose_rad = {0, 0, 1.5707963267948966};
  EXPECT_THROW(tip_of(scenario, Axis::x), InputError);
}

}  // namespace
}  // namespace handloop::models
