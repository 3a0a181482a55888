#include <gtest/gtest.h>

#include "tests/sim/plant_loop.h"

/// Effects in the MuJoCo plant against their linear stand-ins: the response of the simulated arm with an effect must be
/// that of models::compliance with it. Effects that are linear at any size; the others pass the same code.
namespace handloop::sim {
namespace {

using namespace testing_support;
using Eigen::Vector3d;
using models::Axis;
using models::Place;

constexpr double kPeriod_s = 2.0;

models::EffectPtr effect(std::string_view name, Place place,
                         const std::vector<std::pair<std::string_view, double>>& set) {
  const auto& type = models::find_effect_type(name);
  std::vector<double> values;
  for (const auto& parameter : type.info.parameters) values.push_back(parameter.typical);
  for (const auto& [key, value] : set) values.at(type.info.parameter_index(key)) = value;
  return models::make_effect(name, place, values);
}

struct Signals {
  std::vector<double> force, position, command;
};

/// One period of steady motion under eight sines, as sensors and encoders tell it.
Signals record(const models::Scenario& scenario, Axis axis, std::span<const double> lines_Hz) {
  PhantomPlant plant(scenario);
  const auto& description = plant.description();
  const auto device = models::phantom_parameters(scenario.device.parameter_set, scenario.device.stylus_mass_kg);
  const int row = models::device_row(axis);
  const double T = scenario.loop.sample_time_s;
  const auto period = static_cast<std::size_t>(std::lround(kPeriod_s / T));
  Signals signals;
  const auto input = [&](std::size_t k) {
    double f = 0;
    for (std::size_t i = 0; i < lines_Hz.size(); ++i) {
      f += 0.4 * std::cos(2 * std::numbers::pi *
                          (lines_Hz[i] * static_cast<double>(k) * T + 0.31 * static_cast<double>(i * i)));
    }
    Vector3d force = Vector3d::Zero();
    force[static_cast<int>(axis)] = f;
    return force;
  };
  push_with(plant, scenario, 3 * period, input, [&](std::size_t k, const PhantomPlant& at) {
    const auto reading = at.read();
    const double top = std::ldexp(1.0, description.adc_bits) - 1;
    const double volts = description.adc_range_V * (2 * reading.adc_codes[static_cast<std::size_t>(row)] / top - 1);
    signals.force.push_back(volts * description.analog_N_per_V[static_cast<std::size_t>(row)]);
    signals.position.push_back(models::phantom_tip(device, joint_angles(description, reading))[row]);
    signals.command.push_back(input(k)[static_cast<int>(axis)]);
  });
  return signals;
}

const std::array<double, 8> kLines_Hz{1.0, 2.5, 4.0, 7.0, 11.0, 15.0, 21.0, 28.0};

void expect_linear_stand_in(const models::EffectPtr& added, Axis axis) {
  auto scenario = nominal_scenario();
  scenario.loop.sample_time_s = 0.0005;
  scenario.arm.effects.emplace_back(axis, added);
  const auto signals = record(scenario, axis, kLines_Hz);
  models::AxisModel model;
  model.axis = axis;
  model.arm = scenario.arm.axes[static_cast<std::size_t>(axis)];
  model.effects = {added};
  const std::size_t from = signals.force.size() / 3 * 2;
  for (const double f : kLines_Hz) {
    const auto measured = bin(signals.position, from, f, 0.0005) / bin(signals.force, from, f, 0.0005);
    const auto expected = models::compliance(model, {}, {0.0, 2 * std::numbers::pi * f});
    const auto ratio = measured / expected;
    // slow poles have not quite died out after two periods
    EXPECT_NEAR(std::abs(ratio), 1.0, 0.01) << added->info().name << " at " << f << " Hz";
    EXPECT_NEAR(std::arg(ratio), 0.0, 0.01) << added->info().name << " at " << f << " Hz";
  }
}

TEST(PlantEffects, ReflexWithDelayActsAsItsStandInSays) {
  expect_linear_stand_in(effect("reflex_feedback", Place::arm, {{"velocity_gain_Ns_per_m", 3.0}, {"delay_s", 0.0403}}),
                         Axis::x);
}

TEST(PlantEffects, ViscoelasticRelaxationActsAsItsStandInSays) {
  expect_linear_stand_in(models::make_typical_effect("viscoelastic_relaxation", Place::arm), Axis::x);
}

TEST(PlantEffects, FlexibleModeActsAsItsStandInSays) {
  expect_linear_stand_in(effect("flexible_mode", Place::arm, {{"mass_kg", 0.05}, {"frequency_Hz", 14.0}}), Axis::x);
  expect_linear_stand_in(effect("flexible_mode", Place::joint, {{"mass_kg", 0.02}, {"frequency_Hz", 14.0}}), Axis::y);
}

TEST(PlantEffects, MassOnTheArmActsAsItsStandInSays) {
  expect_linear_stand_in(effect("added_mass", Place::arm, {{"mass_kg", 0.04}}), Axis::x);
  expect_linear_stand_in(effect("added_mass", Place::arm, {{"mass_kg", 0.04}}), Axis::z);
}

/// Beyond the sensor a mass is felt as force times an acceleration. Of the motors' force, which jumps at each sample,
/// the mass takes its share mu of all that moves; the sensor is read just before the jump, so that share is felt half a
/// sample late. That is so on a real device too.
TEST(PlantEffects, MassBeyondTheSensorIsFeltHalfASampleLate) {
  constexpr double kMass_kg = 0.04, kSample_s = 0.0005;
  for (const auto place : {Place::grasp, Place::joint}) {
    for (const auto axis : {Axis::x, Axis::z}) {
      auto scenario = nominal_scenario();
      scenario.loop.sample_time_s = kSample_s;
      scenario.arm.effects.emplace_back(axis, effect("added_mass", place, {{"mass_kg", kMass_kg}}));
      const auto signals = record(scenario, axis, kLines_Hz);
      const std::size_t from = signals.force.size() / 3 * 2;
      const auto device = models::phantom_parameters(models::PhantomParameterSet::cavusoglu, 0.052);
      const double mu = kMass_kg / (kMass_kg + models::phantom_tip_inertia_kg(device, Vector3d::Zero(), axis));
      for (const double f : kLines_Hz) {
        const std::complex<double> s{0.0, 2 * std::numbers::pi * f};
        const auto measured = bin(signals.position, from, f, kSample_s) / bin(signals.force, from, f, kSample_s);
        const auto arm = 1.0 / models::compliance(scenario.arm.axes[static_cast<std::size_t>(axis)], s);
        const auto held = (1.0 - mu) * arm + (mu * arm + kMass_kg * s * s) * std::exp(-0.5 * kSample_s * s);
        EXPECT_LT(std::abs(measured * held - 1.0), 0.01) << models::place_name(place) << " at " << f << " Hz";
      }
    }
  }
}

TEST(PlantEffects, LateAndSlowEncodersActAsTheirStandInsSay) {
  expect_linear_stand_in(effect("time_delay", Place::sensor, {{"delay_s", 0.0047}}), Axis::x);
  expect_linear_stand_in(effect("sensor_lag", Place::sensor, {{"time_constant_s", 0.006}}), Axis::y);
}

/// What acts on the actuator does not stand between force and position at the grip, but between command and both.
TEST(PlantEffects, LateAndSlowMotorsDelayWhatTheyAreToldAndNothingElse) {
  const Axis axis = Axis::x;
  auto plain = nominal_scenario();
  plain.loop.sample_time_s = 0.0005;
  const auto without = record(plain, axis, kLines_Hz);
  for (const auto& added : {effect("time_delay", Place::actuator, {{"delay_s", 0.00313}}),
                            effect("sensor_lag", Place::actuator, {{"time_constant_s", 0.004}})}) {
    auto scenario = plain;
    scenario.arm.effects.emplace_back(axis, added);
    const auto with = record(scenario, axis, kLines_Hz);
    const std::size_t from = with.force.size() / 3 * 2;
    for (const double f : kLines_Hz) {
      const std::complex<double> s{0.0, 2 * std::numbers::pi * f};
      const auto change = bin(with.position, from, f, 0.0005) / bin(without.position, from, f, 0.0005);
      EXPECT_LT(std::abs(change / added->linearise({}, {})(s) - 1.0), 0.01)
          << added->info().name << " at " << f << " Hz";
    }
  }
}

TEST(PlantEffects, OffsetOfTheEncodersIsReadAndNotThere) {
  auto scenario = nominal_scenario();
  scenario.arm.effects.emplace_back(Axis::z, effect("offset", Place::sensor, {{"position_m", 0.002}}));
  PhantomPlant plant(scenario);
  const auto device = models::phantom_parameters(scenario.device.parameter_set, scenario.device.stylus_mass_kg);
  const double home = models::phantom_tip(device, Vector3d::Zero())[models::device_row(Axis::z)];
  const double read =
      models::phantom_tip(device, joint_angles(plant.description(), plant.read()))[models::device_row(Axis::z)];
  EXPECT_NEAR(read - home, 0.002, 2e-5);  // J^-1 to first order
  EXPECT_NEAR(plant.truth().tip_m[2], 0.0, 1e-12);
}

TEST(PlantEffects, EveryEffectOfTheCatalogueRunsAtEveryPlaceItMayAct) {
  for (const auto& type : models::effect_catalogue()) {
    for (const auto place : type.info.places) {
      auto scenario = nominal_scenario();
      scenario.arm.effects.emplace_back(Axis::z, models::make_typical_effect(type.info.name, place));
      PhantomPlant plant(scenario);
      push_with(
          plant, scenario, 500, [](std::size_t k) { return Vector3d(0, 0, k < 250 ? 1.0 : -1.0); },
          [](std::size_t, const PhantomPlant&) {});
      EXPECT_FALSE(plant.truth().diverged) << type.info.name << " at " << models::place_name(place);
      EXPECT_LT(std::abs(plant.truth().tip_m[2]), 0.1) << type.info.name << " at " << models::place_name(place);
    }
  }
}

TEST(PlantEffects, RigidHandIsMassSpringAndDamperAtTheGrip) {
  const Axis axis = Axis::x;
  auto scenario = nominal_scenario();
  scenario.loop.sample_time_s = 0.0005;
  const models::MsdParameters msd{0.3, 5.0, 250.0};
  scenario.arm.rigid[0] = msd;
  const auto signals = record(scenario, axis, kLines_Hz);
  const std::size_t from = signals.force.size() / 3 * 2;
  for (const double f : kLines_Hz) {
    const std::complex<double> s{0.0, 2 * std::numbers::pi * f};
    const auto measured = bin(signals.position, from, f, 0.0005) / bin(signals.force, from, f, 0.0005);
    const auto inertia = msd.mass_kg * s * s * std::exp(-0.5 * 0.0005 * s);  // felt half a sample late, as above
    EXPECT_LT(std::abs(measured * (inertia + msd.b_Ns_per_m * s + msd.k_N_per_m) - 1.0), 0.01) << f << " Hz";
  }
}

}  // namespace
}  // namespace handloop::sim
