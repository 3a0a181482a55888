#include <gtest/gtest.h>

#include <cmath>

#include "control/closed_loop_verdict.h"
#include "control/margins.h"
#include "control/stability_boundary.h"
#include "models/arm_tables.h"
#include "models/errors.h"
#include "models/random.h"

namespace handloop::control {
namespace {

/// Loops all over the place: arms from the smallest of Table III to heavier than any, devices from 20 g to 6 kg.
Loop random_loop(std::uint64_t index) {
  const models::CounterRandom random(11, models::RandomStream::test);
  const auto u = random.uniforms(index), v = random.uniforms(index, 1), w = random.uniforms(index, 2);
  const auto between = [](double low, double high, double p) { return low * std::pow(high / low, p); };
  Loop loop;
  loop.plant.tip_mass_kg = between(0.02, 6, u[0]);
  loop.plant.tip_damping_Ns_per_m = between(0.001, 4, u[1]);
  loop.plant.arm = models::ArmParameters{between(3e-4, 0.9, u[2]), between(50, 6000, u[3]), between(2, 800, v[0]),
                                         between(2e-4, 10, v[1]), between(0.05, 40, v[2])};
  loop.timing = {between(2e-4, 4e-3, v[3]), static_cast<int>(4 * w[0]), between(20, 1000, w[1])};
  loop.gains = {between(5, 8000, w[2]), w[3] < 0.3 ? 0.0 : between(0.01, 12, w[3])};
  return loop;
}

TEST(Verdict, AgreesWithThePoles) {
  int stable = 0;
  for (std::uint64_t i = 0; i < 20000; ++i) {
    const Loop loop = random_loop(i);
    const SampledPlant plant = sample_plant(loop.plant, loop.timing.sample_time_s);
    const double rho = closed_loop_poles(plant, loop.timing, loop.gains).rho();
    if (std::abs(rho - 1) < 1e-11) continue;
    ASSERT_EQ(ClosedLoopVerdict(plant, loop.timing).stable(loop.gains), rho < 1) << i << ' ' << rho;
    stable += rho < 1;
  }
  EXPECT_GT(stable, 2000);
  EXPECT_LT(stable, 18000);
}

TEST(Verdict, StableStiffnessEndsWhereThePolesReachTheCircle) {
  for (std::uint64_t i = 0; i < 300; ++i) {
    const Loop loop = random_loop(i);
    const SampledPlant plant = sample_plant(loop.plant, loop.timing.sample_time_s);
    const auto stable = stable_stiffness(plant, loop.timing, loop.gains.damping_Ns_per_m);
    const auto rho = [&](double K) {
      return closed_loop_poles(plant, loop.timing, {K, loop.gains.damping_Ns_per_m}).rho();
    };
    for (int k = 0; k < stable.count; ++k) {
      const auto& part = stable.intervals[static_cast<std::size_t>(k)];
      ASSERT_TRUE(std::isfinite(part.high)) << i;
      EXPECT_NEAR(rho(part.high), 1, 1e-10) << i;
      EXPECT_GT(rho(part.high * 1.001), 1) << i;
      EXPECT_LT(rho(0.5 * (part.low + part.high)), 1) << i;
    }
    // and nowhere else
    for (double K = 3; K < 3e4; K *= 1.31) {
      bool inside = false;
      for (int k = 0; k < stable.count; ++k) {
        const auto& part = stable.intervals[static_cast<std::size_t>(k)];
        inside = inside || (K > part.low && K < part.high);
      }
      EXPECT_EQ(inside, rho(K) < 1) << i << ' ' << K;
    }
  }
}

TEST(Verdict, BoundaryPiecesHaveAPoleOnTheCircleEverywhere) {
  for (const auto axis : models::kAxes) {
    const LoopPlant tip{0.075, 0.05, models::nominal_arm(axis)};
    const LoopTiming timing;
    const SampledPlant plant = sample_plant(tip, timing.sample_time_s);
    const auto pieces = trace_boundary(plant, timing, {0, 6000, 0, 60});
    ASSERT_FALSE(pieces.empty());
    std::size_t points = 0;
    for (const auto& piece : pieces) {
      for (const auto& p : piece.points) {
        EXPECT_NEAR(closed_loop_poles(plant, timing, {p.stiffness_N_per_m, p.damping_Ns_per_m}).rho(), 1, 1e-9);
        ++points;
      }
    }
    EXPECT_GT(points, 200U);
    // where the curve starts on the axis B = 0 is the critical stiffness
    double lowest = 1e9;
    for (const auto& piece : pieces) {
      for (const auto& p : piece.points) {
        if (p.damping_Ns_per_m < 1e-6) lowest = std::min(lowest, p.stiffness_N_per_m);
      }
    }
    EXPECT_NEAR(lowest / critical_stiffness(plant, timing, 0), 1, 1e-6);
  }
}

TEST(Verdict, RefusesDelaysItCannotJudge) {
  LoopTiming timing;
  timing.delay_samples = 9;
  EXPECT_THROW(ClosedLoopVerdict(sample_plant({}, 1e-3), timing), InputError);
}

}  // namespace
}  // namespace handloop::control
