/// The exam's own simulator must be right before anything is judged by it.
#include "tests/support/planted_recording.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "tests/support/planted_plant.h"
#include "tests/support/planted_recipes.h"

namespace handloop::tests {
namespace {

Plant nominal_x() {
  Plant p;
  p.M = 0.2179, p.k1 = 379.5, p.k2 = 78.75, p.b1 = 1.839, p.b2 = 4.645;
  return p;
}

Drive sine(double frequency_Hz, double seconds) {
  Drive d;
  d.held = false;
  d.force.resize(static_cast<std::size_t>(seconds * 1000));
  for (std::size_t i = 0; i < d.force.size(); ++i)
    d.force[i] = std::sin(2 * std::numbers::pi * frequency_Hz * static_cast<double>(i) * 1e-3);
  return d;
}

std::complex<double> response_at(double frequency_Hz, const std::vector<double>& y, std::size_t from) {
  std::complex<double> sum = 0;
  for (std::size_t i = from; i < y.size(); ++i)
    sum += y[i] * std::polar(1.0, -2 * std::numbers::pi * frequency_Hz * static_cast<double>(i) * 1e-3);
  return sum * std::complex<double>(0, 2) / static_cast<double>(y.size() - from);
}

TEST(PlantedRecording, ThePlantWithoutEffectsAnswersAsEquationOneSays) {
  const Plant p = nominal_x();
  for (const double f : {1.0, 5.0, 20.0}) {
    const std::complex<double> s(0, 2 * std::numbers::pi * f);
    const std::complex<double> expected =
        (p.M * s * s + (p.b1 + p.b2) * s + p.k1 + p.k2) /
        (p.b1 * p.M * s * s * s + (p.b1 * p.b2 + p.k1 * p.M) * s * s + (p.b2 * p.k1 + p.b1 * p.k2) * s + p.k1 * p.k2);
    const std::complex<double> found = response_at(f, run_plant(p, sine(f, 6)), 4000);
    EXPECT_LT(std::abs(found / expected - 1.0), 5e-5) << f << " Hz";  // residual 1e-5: the cubic between samples
  }
}

TEST(PlantedRecording, AFinerStepChangesLessThanTheEncoderSees) {
  Draw draw(3);
  const Plant arm = nominal_x();
  const MotionScale scale;
  Drive drive;
  drive.force = coloured_force(draw, 5000, 1e-3, 1.5, 5.0);
  drive.tremor = narrow_band(draw, 5000, 1e-3, 8, 0.5);
  std::vector<std::string> names = planted_singles();
  names.insert(names.end(), planted_outsiders().begin(), planted_outsiders().end());
  for (const std::string& name : names) {
    const Recipe recipe = draw_recipe(name, draw, arm, scale);
    Plant plant = arm;
    recipe.apply(plant, std::sqrt(recipe.lo * recipe.hi));
    drive.steps_per_sample = 20;
    const std::vector<double> coarse = run_plant(plant, drive);
    drive.steps_per_sample = 80;
    const std::vector<double> fine = run_plant(plant, drive);
    ASSERT_FALSE(coarse.empty()) << name;
    // largest is the exact stick-slip (its events fall on steps), 5.5e-6 m; a count of the encoder is 3e-5 m
    EXPECT_LT(rms_difference(coarse, fine, 0), 1e-5) << name << " (" << recipe.variant << ")";
  }
}

TEST(PlantedRecording, TheSameSeedGivesTheSameRecordingAndAnotherSeedAnother) {
  const PlantedOptions brief{8.0};
  const PlantedRecording a = plant_recording("cubic_stiffness", 5, brief),
                         b = plant_recording("cubic_stiffness", 5, brief);
  EXPECT_EQ(a.force, b.force);
  EXPECT_EQ(a.position, b.position);
  EXPECT_NE(a.force, plant_recording("cubic_stiffness", 6, brief).force);
}

TEST(PlantedRecording, WhatIsPlantedCanBeSeenAndWhatIsNotPlantedCannot) {
  const PlantedOptions options{20.0};
  for (const char* name : {"coulomb_friction", "time_delay", "backlash", "one_sided_stop"}) {
    const PlantedRecording r = plant_recording(name, 11, options);
    EXPECT_GE(r.ratio(), 2.0) << name;
    EXPECT_LE(r.ratio(), 100.0) << name;
  }
  const PlantedRecording clean = plant_recording("none", 11);
  EXPECT_LT(clean.ratio(), 1.15);  // 1.0 to 1.06: a fit follows a little of the wander
  EXPECT_TRUE(clean.truth.empty());
}

TEST(PlantedRecording, ForcesAndPositionsStayWithinWhatTheBenchCouldRecord) {
  const PlantedRecording r = plant_recording("reflex_feedback", 2, {20.0});
  for (const double f : r.force) ASSERT_LT(std::abs(f), 5.2);
  for (const double x : r.position) ASSERT_LT(std::abs(x), 0.3);
  for (const double x : r.position) ASSERT_NEAR(x / 3e-5, std::round(x / 3e-5), 1e-6);  // counts of the encoder
}

}  // namespace
}  // namespace handloop::tests
