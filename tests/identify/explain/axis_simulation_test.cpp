#include "identify/explain/axis_simulation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

namespace handloop::identify {
namespace {

using models::Place;

models::AxisModel nominal_x() {
  models::AxisModel model;
  model.arm = {0.2179, 379.5, 78.75, 1.839, 4.645};
  return model;
}

std::vector<double> sine(double frequency_Hz, std::size_t samples) {
  std::vector<double> force(samples);
  for (std::size_t i = 0; i < samples; ++i)
    force[i] = std::sin(2 * std::numbers::pi * frequency_Hz * static_cast<double>(i) * 1e-3);
  return force;
}

/// Complex amplitude of the last whole second.
std::complex<double> amplitude(const std::vector<double>& signal, double frequency_Hz) {
  std::complex<double> sum = 0;
  for (std::size_t i = signal.size() - 1000; i < signal.size(); ++i) {
    sum += signal[i] * std::polar(1.0, -2 * std::numbers::pi * frequency_Hz * static_cast<double>(i) * 1e-3);
  }
  return sum / 500.0 * std::complex<double>(0, 1);
}

/// Every linear effect, alone: the simulation against the model's own compliance. Worst residual 0.4 % (flexible mode,
/// 11 Hz).
TEST(AxisSimulation, FollowsTheComplianceOfEveryLinearEffect) {
  const std::vector<std::pair<const char*, Place>> cases{{"added_mass", Place::grasp},
                                                         {"added_mass", Place::arm},
                                                         {"viscoelastic_relaxation", Place::arm},
                                                         {"viscoelastic_relaxation", Place::grasp},
                                                         {"reflex_feedback", Place::arm},
                                                         {"flexible_mode", Place::arm},
                                                         {"time_delay", Place::sensor},
                                                         {"sensor_lag", Place::sensor},
                                                         {"time_delay", Place::actuator}};
  for (const double frequency : {2.0, 5.0, 11.0, 25.0}) {
    const auto force = sine(frequency, 8000);
    const std::complex<double> s(0, 2 * std::numbers::pi * frequency);
    for (const auto& [name, place] : cases) {
      auto model = nominal_x();
      model.effects.push_back(models::make_typical_effect(name, place));
      const auto run = simulate_position(model, force, {.hold = Hold::first_order});
      ASSERT_TRUE(run.finite) << name;
      const auto expected = models::compliance(model, {}, s);
      EXPECT_LT(std::abs(amplitude(run.output, frequency) - expected), 0.01 * std::abs(expected))
          << name << " at " << frequency << " Hz";
    }
  }
}

TEST(AxisSimulation, InverseModelReturnsTheForceThatMadeTheMotion) {
  auto model = nominal_x();
  model.effects.push_back(models::make_typical_effect("cubic_stiffness", Place::arm));
  const auto force = sine(4.0, 6000);
  const auto run = simulate_position(model, force, {.hold = Hold::first_order});
  GripMotion grip{run.output, {}, {}};
  grip.velocity_m_per_s.assign(6000, 0.0);
  grip.acceleration_m_per_s2.assign(6000, 0.0);
  for (std::size_t i = 1; i + 1 < 6000; ++i) grip.velocity_m_per_s[i] = (run.output[i + 1] - run.output[i - 1]) / 2e-3;
  const auto back = simulate_force(model, grip, {});
  double worst = 0;
  for (std::size_t i = 3000; i + 1 < 6000; ++i) worst = std::max(worst, std::abs(back.output[i] - force[i]));
  EXPECT_LT(worst, 5e-3);  // of a force of 1 N; 1.1e-3 measured
}

}  // namespace
}  // namespace handloop::identify
