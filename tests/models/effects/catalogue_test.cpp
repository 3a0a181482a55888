#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "models/effects/effect.h"
#include "models/errors.h"

namespace handloop::models {
namespace {

constexpr PortBase kBase{300, 5, 0.2};

/// What a motion of given rms draws from an effect: least-squares fit of its force by displacement and velocity.
struct Response {
  double stiffness, damping;
  double work_W;  ///< mean power taken from the motion
};

/// Memoryless laws, under independent Gaussian displacement and velocity.
Response under_gaussian_motion(const Effect& effect, double x_rms, double v_rms, double t) {
  constexpr int kDraws = 400'000;
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  double fx = 0, fv = 0, power = 0;
  for (int i = 0; i < kDraws; ++i) {
    const PortMotion motion{t, x_rms * normal(random), v_rms * normal(random)};
    const double force = effect.force_N(motion, kBase, {});
    fx += force * motion.x_m;
    fv += force * motion.v_m_per_s;
    power += force * motion.v_m_per_s;
  }
  return {fx / (kDraws * x_rms * x_rms), fv / (kDraws * v_rms * v_rms), power / kDraws};
}

/// Laws with memory, under a sine: the last of twelve cycles, integrated by the midpoint rule.
Response under_sine(const Effect& effect, double x_rms, double omega) {
  constexpr int kStepsPerCycle = 20'000, kCycles = 12;
  const double step = 2 * std::numbers::pi / omega / kStepsPerCycle, amplitude = x_rms * std::numbers::sqrt2;
  const auto port = [&](double t) {
    const double before = t - effect.delay_s();
    return PortMotion{t, amplitude * std::sin(omega * t), amplitude * omega * std::cos(omega * t),
                      amplitude * std::sin(omega * before), amplitude * omega * std::cos(omega * before)};
  };
  std::vector<double> states(effect.state_count()), rates(effect.state_count()), middle(effect.state_count());
  double xx = 0, vv = 0, fx = 0, fv = 0;
  for (int i = 0; i < kCycles * kStepsPerCycle; ++i) {
    const double t = i * step;
    const PortMotion now = port(t);
    const double force = effect.force_N(now, kBase, states) - effect.added_mass_kg(t) * omega * omega * now.x_m;
    if (i >= (kCycles - 1) * kStepsPerCycle) {
      xx += now.x_m * now.x_m;
      vv += now.v_m_per_s * now.v_m_per_s;
      fx += force * now.x_m;
      fv += force * now.v_m_per_s;
    }
    effect.state_rates(now, kBase, states, rates);
    for (std::size_t s = 0; s < states.size(); ++s) middle[s] = states[s] + 0.5 * step * rates[s];
    effect.state_rates(port(t + 0.5 * step), kBase, middle, rates);
    for (std::size_t s = 0; s < states.size(); ++s) states[s] += step * rates[s];
  }
  return {fx / xx, fv / vv, fv / kStepsPerCycle};
}

TEST(EffectCatalogue, HoldsEveryNameOfTheContractOnce) {
  const std::set<std::string_view> wanted{"coulomb_friction",
                                          "stribeck_friction",
                                          "quadratic_damping",
                                          "cubic_stiffness",
                                          "asymmetric_stiffness",
                                          "backlash",
                                          "hysteresis",
                                          "viscoelastic_relaxation",
                                          "reflex_feedback",
                                          "time_delay",
                                          "sensor_lag",
                                          "added_mass",
                                          "flexible_mode",
                                          "position_ripple",
                                          "parameter_drift",
                                          "tremor",
                                          "offset",
                                          "gravity",
                                          "tabulated"};
  std::set<std::string_view> found;
  for (const auto& type : effect_catalogue()) EXPECT_TRUE(found.insert(type.info.name).second) << type.info.name;
  EXPECT_EQ(found, wanted);
}

TEST(EffectCatalogue, TypicalValuesLieWithinTheirBounds) {
  for (const auto& type : effect_catalogue()) {
    ASSERT_FALSE(type.info.places.empty());
    for (const Place place : type.info.places)
      EXPECT_NO_THROW(make_typical_effect(type.info.name, place)) << type.info.name;
    for (const auto& parameter : type.info.parameters) EXPECT_LT(parameter.lower, parameter.upper) << parameter.name;
  }
}

TEST(EffectCatalogue, RefusesUnknownNamesPlacesAndValuesWithAHint) {
  try {
    find_effect_type("coulom_friction");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("coulomb_friction"), std::string::npos) << error.what();
  }
  EXPECT_THROW(make_typical_effect("time_delay", Place::arm), InputError);
  EXPECT_THROW(make_effect("cubic_stiffness", Place::arm, std::array{std::nan("")}), InputError);
  EXPECT_THROW(make_effect("added_mass", Place::grasp, std::array{-0.1}), InputError);
  EXPECT_THROW(parse_place("elbow"), InputError);
}

/// Every force effect against its own linearisation. Worst residual: 0.6 % of |F/X| without memory (400,000 draws), 0.4
/// % with memory.
class ForceEffect : public testing::TestWithParam<std::string_view> {};

TEST_P(ForceEffect, LinearisesToTheForceThatMotionDraws) {
  constexpr double kXRms = 1e-3, kTime = 3.0;
  const auto effect = make_typical_effect(GetParam(), find_effect_type(GetParam()).info.places.front());
  const bool memory = effect->state_count() > 0 || effect->added_mass_kg(0.0) > 0;
  for (const double frequency : {2.0, 9.0}) {
    const double omega = 2 * std::numbers::pi * frequency;
    const auto measured =
        memory ? under_sine(*effect, kXRms, omega) : under_gaussian_motion(*effect, kXRms, omega * kXRms, kTime);
    const auto linear = effect->linearise({kXRms, omega * kXRms, 0.0, kTime}, kBase)({0, omega});
    EXPECT_NEAR(measured.stiffness, linear.real(), 0.01 * std::abs(linear)) << frequency << " Hz";
    EXPECT_NEAR(measured.damping * omega, linear.imag(), 0.01 * std::abs(linear)) << frequency << " Hz";
  }
}

INSTANTIATE_TEST_SUITE_P(All, ForceEffect,
                         testing::Values("coulomb_friction", "stribeck_friction", "quadratic_damping",
                                         "cubic_stiffness", "backlash", "hysteresis", "viscoelastic_relaxation",
                                         "reflex_feedback", "added_mass", "flexible_mode", "position_ripple",
                                         "parameter_drift"),
                         [](const auto& tested) { return std::string(tested.param); });

TEST(FrictionEffects, TakeEnergyFromTheMotion) {
  for (const auto name :
       {"coulomb_friction", "stribeck_friction", "quadratic_damping", "hysteresis", "viscoelastic_relaxation"}) {
    const auto effect = make_typical_effect(name, Place::arm);
    const auto response =
        effect->state_count() > 0 ? under_sine(*effect, 3e-3, 25.0) : under_gaussian_motion(*effect, 3e-3, 0.07, 0.0);
    EXPECT_GT(response.work_W, 0.0) << name;
  }
}

}  // namespace
}  // namespace handloop::models
