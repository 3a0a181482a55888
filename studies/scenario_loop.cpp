#include "studies/scenario_loop.h"

#include <algorithm>

#include "models/scenario_tip.h"

namespace handloop::studies {
namespace {

std::size_t index(models::Axis axis) {
  return static_cast<std::size_t>(axis);
}

}  // namespace

models::AxisModel hand_model(const models::Scenario& scenario, models::Axis axis) {
  models::AxisModel model;
  model.axis = axis;
  model.arm = scenario.arm.axes[index(axis)];
  if (const auto& rigid = scenario.arm.rigid[index(axis)]) {
    model.base = models::BaseModel::msd;
    model.msd = *rigid;
  }
  for (const auto& [on, effect] : scenario.arm.effects) {
    if (on == axis) model.effects.push_back(effect);
  }
  return model;
}

control::Loop loop_of(const models::Scenario& scenario, models::Axis axis) {
  const auto tip = models::tip_of(scenario, axis);
  control::Loop loop;
  loop.plant = {tip.mass_kg, tip.damping_Ns_per_m, {}};
  if (scenario.arm.attached && !scenario.arm.rigid[index(axis)]) loop.plant.arm = scenario.arm.axes[index(axis)];
  loop.timing = {scenario.loop.sample_time_s, scenario.loop.delay_samples, scenario.loop.cutoff_Hz};
  loop.gains = {scenario.loop.stiffness_N_per_m, scenario.loop.damping_Ns_per_m};
  return loop;
}

bool needs_linear_plant(const models::Scenario& scenario, models::Axis axis) {
  const auto on_axis = [axis](const auto& entry) { return entry.first == axis; };
  return scenario.arm.attached &&
         (scenario.arm.rigid[index(axis)].has_value() || std::ranges::any_of(scenario.arm.effects, on_axis));
}

}  // namespace handloop::studies
