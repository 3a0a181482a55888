#include <benchmark/benchmark.h>
#include <mujoco/mujoco.h>

#include <cmath>

#include "models/arm_tables.h"
#include "sim/phantom_plant.h"
#include "sim/phantom_scene.h"

/// Steps a second of the whole plant (electronics, arms, Runge-Kutta stages, closed parallelogram) against bare mj_step
/// on the same compiled model with the same integrator and step.
namespace {

using namespace handloop;

models::Scenario scenario() {
  models::Scenario scenario;
  for (const auto axis : models::kAxes) scenario.arm.axes[static_cast<std::size_t>(axis)] = models::nominal_arm(axis);
  scenario.hand.push_N = 0.0;
  return scenario;
}

void BareMjStep(benchmark::State& state) {
  const auto scene = sim::load_phantom(scenario().device, false);
  const auto data = sim::make_data(scene.model.get());
  const mjModel* model = scene.model.get();
  long k = 0;
  for (auto _ : state) {
    // held in place by springs, as by an arm
    for (int i = 0; i < 3; ++i) {
      const int dof = scene.motor_dof[i];
      data->ctrl[i] = 0.02 * std::sin(0.03 * static_cast<double>(k)) - 2.0 * data->qpos[dof] - 0.02 * data->qvel[dof];
    }
    mj_step(model, data.get());
    ++k;
  }
  state.SetItemsProcessed(state.iterations());
}
BENCHMARK(BareMjStep);

void PlantSample(benchmark::State& state) {
  sim::PhantomPlant plant(scenario());
  long k = 0;
  for (auto _ : state) {
    sim::PlantCommand command;
    for (std::size_t i = 0; i < 3; ++i) {
      command.dac_codes[i] = 2048 + static_cast<std::uint32_t>(100 + 90 * std::sin(0.03 * static_cast<double>(k)));
    }
    plant.advance(command);
    benchmark::DoNotOptimize(plant.read());
    ++k;
  }
  state.SetItemsProcessed(state.iterations());
}
BENCHMARK(PlantSample);

}  // namespace

BENCHMARK_MAIN();
