#include "identify/explain/force_scan.h"

#include <algorithm>
#include <map>

#include "identify/explain/force_view.h"

namespace handloop::identify {
std::vector<ForceStart> force_scan(const Prediction& prediction, const Hypothesis& from,
                                   const std::vector<Variant>& variants) {
  const auto changes_grasp = [](std::string_view name, models::Place place) {
    return place == models::Place::grasp && name != "added_mass";
  };
  if (prediction.driven_by() != DrivenBy::force || from.model.base != models::BaseModel::arm5) return {};
  for (const auto& effect : from.model.effects) {
    if (changes_grasp(effect->info().name, effect->place())) return {};
  }
  std::map<std::string_view, ForceStart> best;
  const auto keep = [&](ForceStart start) {
    const auto [at, fresh] = best.try_emplace(start.variant.type->info.name, start);
    if (!fresh && start.left < at->second.left) at->second = std::move(start);
  };
  const ForceView own(prediction, from.model);
  for (const auto& variant : variants) {
    const bool on_signal = variant.place == models::Place::actuator || variant.place == models::Place::sensor;
    if (on_signal != used_gains(variant).empty() || changes_grasp(variant.type->info.name, variant.place)) continue;
    for_each_start(variant, scale_at(own.motion(), variant.place), [&](std::vector<double> values) {
      keep(own.regress({variant.type, variant.place, std::move(values)}));
    });
  }
  // the grasp may be bent as well: the best of each with other grasps
  for (const auto& arm : kUsualArms) {
    auto model = from.model;
    model.arm = arm;
    const ForceView other(prediction, model);
    for (auto& [name, start] : best) keep(other.regress(start.variant));
  }
  std::vector<ForceStart> starts;
  for (auto& [name, start] : best) {
    if (start.left < 1) starts.push_back(std::move(start));
  }
  std::sort(starts.begin(), starts.end(), [](const auto& a, const auto& b) { return a.left < b.left; });
  return starts;
}

}  // namespace handloop::identify
