#include "identify/explain/force_scan.h"

#include <algorithm>
#include <functional>
#include <map>
#include <utility>

#include "identify/explain/force_view.h"

namespace handloop::identify {
namespace {

using Gains = std::vector<std::size_t>;

bool changes_grasp(std::string_view name, models::Place place) {
  return place == models::Place::grasp && name != "added_mass";
}

bool has_force_view(const Prediction& prediction, const Hypothesis& from) {
  return prediction.driven_by() == DrivenBy::force && from.model.base == models::BaseModel::arm5 &&
         std::ranges::none_of(from.model.effects, [](const auto& effect) {
           return changes_grasp(effect->info().name, effect->place());
         });
}

/// All gains at once.
std::vector<Gains> together(const Variant& variant) {
  return {used_gains(variant)};
}

/// Each gain alone, where they are of different kinds; sine and cosine of one force are not.
std::vector<Gains> one_by_one(const Variant& variant) {
  const auto gains = used_gains(variant);
  const auto unit = [&](std::size_t gain) { return variant.type->info.parameters[gain].unit; };
  if (std::ranges::all_of(gains, [&](auto gain) { return unit(gain) == unit(gains.front()); })) return {};
  std::vector<Gains> single;
  for (const auto gain : gains) single.push_back({gain});
  return single;
}

/// The best start of each effect with each of its sets of gains, most explained first.
std::vector<ForceStart> best_starts(const Prediction& prediction, const Hypothesis& from,
                                    const std::vector<Variant>& variants,
                                    const std::function<std::vector<Gains>(const Variant&)>& sets_of) {
  if (!has_force_view(prediction, from)) return {};
  std::map<std::pair<std::string_view, Gains>, ForceStart> best;
  const auto keep = [&](const Gains& gains, ForceStart start) {
    const auto [at, fresh] = best.try_emplace({start.variant.type->info.name, gains}, start);
    if (!fresh && start.left < at->second.left) at->second = std::move(start);
  };
  const ForceView own(prediction, from.model);
  for (const auto& variant : variants) {
    const bool on_signal = variant.place == models::Place::actuator || variant.place == models::Place::sensor;
    if (on_signal != used_gains(variant).empty() || changes_grasp(variant.type->info.name, variant.place)) continue;
    for (const auto& gains : sets_of(variant)) {
      for_each_start(variant, scale_at(own.motion(), variant.place), [&](std::vector<double> values) {
        keep(gains, own.regress({variant.type, variant.place, std::move(values)}, gains));
      });
    }
  }
  // the grasp may be bent as well: the best of each with other grasps
  for (const auto& arm : kUsualArms) {
    auto model = from.model;
    model.arm = arm;
    const ForceView other(prediction, model);
    for (auto& [key, start] : best) keep(key.second, other.regress(start.variant, key.second));
  }
  std::vector<ForceStart> starts;
  for (auto& [key, start] : best) {
    if (start.left < 1) starts.push_back(std::move(start));
  }
  std::ranges::sort(starts, {}, &ForceStart::left);
  return starts;
}

}  // namespace

std::vector<ForceStart> force_scan(const Prediction& prediction, const Hypothesis& from,
                                   const std::vector<Variant>& variants) {
  return best_starts(prediction, from, variants, together);
}

std::vector<ForceStart> single_gain_scan(const Prediction& prediction, const Hypothesis& from,
                                         const std::vector<Variant>& variants) {
  return best_starts(prediction, from, variants, one_by_one);
}

}  // namespace handloop::identify
