#include "control/linear_plant.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "models/arm_tables.h"

namespace handloop::control {
namespace {

using models::Place;
using Complex = std::complex<double>;

models::AxisModel nominal(models::Axis axis) {
  models::AxisModel model;
  model.axis = axis;
  model.arm = models::nominal_arm(axis);
  return model;
}

models::EffectPtr effect(const char* name, Place place) {
  return models::make_typical_effect(name, place);
}

double relative(double a, double b) {
  return a == b ? 0 : std::abs(a - b) / std::max(std::abs(b), 1e-9);
}

TEST(LinearPlant, WithoutEffectsHasTheMarginsOfTheFastLoop) {
  for (const auto axis : models::kAxes) {
    for (const int delay : {0, 1, 2, 5}) {
      const LoopTiming timing{0.001, delay, 100};
      const WallGains gains{300, 1};
      const Margins slow = evaluate(nominal(axis), {}, 0.075, 0.05, timing, gains);
      const Margins fast = evaluate({{0.075, 0.05, models::nominal_arm(axis)}, timing, gains});
      ASSERT_TRUE(slow.stable && fast.stable);
      // largest seen 3e-10: eigenvalues and a search against roots
      EXPECT_LT(relative(slow.rho, fast.rho), 1e-10);
      EXPECT_LT(relative(slow.gain_up, fast.gain_up), 1e-8);
      EXPECT_LT(relative(slow.gain_down, fast.gain_down), 1e-8);
      EXPECT_LT(relative(slow.phase_deg, fast.phase_deg), 1e-8);
      EXPECT_LT(relative(slow.delay_s, fast.delay_s), 1e-8);
      EXPECT_LT(relative(slow.modulus, fast.modulus), 1e-8);
      EXPECT_LT(relative(slow.disk_alpha, fast.disk_alpha), 1e-8);
    }
  }
}

/// Every effect's linear form, as states, against its formula evaluated at s.
TEST(LinearPlant, RespondsAsTheModelsFormula) {
  for (const auto& type : models::effect_catalogue()) {
    if (type.info.name == "tabulated") continue;  // has no typical values
    for (const Place place : type.info.places) {
      auto model = nominal(models::Axis::z);
      model.effects.push_back(effect(std::string(type.info.name).c_str(), place));
      const LinearPlant plant = linear_plant(model, {}, 0.075, 0.05);
      for (double w = 0.5; w < 300; w *= 1.5) {
        const Complex s(0, w);
        // device beside the model: the model's factor acts on the whole
        Complex factor = 1;
        for (const auto& e : model.effects) {
          if (e->place() == Place::actuator || e->place() == Place::sensor) factor *= e->linearise({}, {})(s);
        }
        const Complex held = factor / models::compliance(model, {}, s);
        const Complex expected = factor / ((0.075 * s + 0.05) * s + held);
        EXPECT_LT(std::abs(plant(s) / expected - 1.0), 1e-6)
            << type.info.name << ' ' << models::place_name(place) << ' ' << w;
      }
    }
  }
}

/// Sampling: the sum over the images of the held response, which knows the delay exactly.
TEST(LinearPlant, SampledIsTheSumOfItsImages) {
  auto model = nominal(models::Axis::x);
  const std::array<double, 1> late{0.00137};
  model.effects.push_back(models::make_effect("time_delay", Place::sensor, late));
  model.effects.push_back(effect("reflex_feedback", Place::arm));
  const double T = 0.001;
  const LinearPlant plant = linear_plant(model, {}, 0.075, 0.05);
  const SampledLinearPlant sampled(plant, T);
  for (double w = 1; w < 2500; w *= 1.7) {
    Complex sum = 0;
    for (int k = -400; k <= 400; ++k) {
      const Complex s(0, w + 2 * std::numbers::pi * k / T);
      sum += plant(s) * (1.0 - std::exp(-s * T)) / (s * T);
    }
    const Complex delta = std::polar(1.0, w * T) - 1.0;
    EXPECT_LT(std::abs(sampled(delta) / sum - 1.0), 1e-6) << w;
  }
}

TEST(LinearPlant, AnActuatorsWholeDelayIsADelayOfTheLoop) {
  auto model = nominal(models::Axis::y);
  const std::array<double, 1> late{0.002};
  model.effects.push_back(models::make_effect("time_delay", Place::actuator, late));
  const WallGains gains{500, 2};
  const Margins with = evaluate(model, {}, 0.075, 0.05, {0.001, 1, 100}, gains);
  const Margins same = evaluate(nominal(models::Axis::y), {}, 0.075, 0.05, {0.001, 3, 100}, gains);
  EXPECT_LT(relative(with.rho, same.rho), 1e-9);
  EXPECT_LT(relative(with.disk_alpha, same.disk_alpha), 1e-8);
}

TEST(LinearPlant, DelayMarginIsTheDelayThatDestabilises) {
  const LoopTiming timing{0.001, 1, 100};
  const WallGains gains{400, 1};
  const Margins before = evaluate(nominal(models::Axis::z), {}, 0.075, 0.05, timing, gains);
  ASSERT_TRUE(before.stable);
  for (const double share : {0.999, 1.001}) {
    auto model = nominal(models::Axis::z);
    const std::array<double, 1> late{share * before.delay_s};
    model.effects.push_back(models::make_effect("time_delay", Place::sensor, late));
    // the added delay is resampled, so the loop is not quite the same function times e^(-s tau): equal within the
    // images
    EXPECT_NEAR(evaluate(model, {}, 0.075, 0.05, timing, gains).rho, 1, 2e-3);
  }
}

}  // namespace
}  // namespace handloop::control
