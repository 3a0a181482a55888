#include "studies/sweep_compare.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

#include "studies/proportions.h"
#include "studies/sweep_requirements.h"

namespace handloop::studies {
namespace {

using Key = std::tuple<int, int, int, double, double>;
Key key_of(const SweepCondition& c, const SweepPoint& p) {
  return {static_cast<int>(c.axis), c.delay_samples, c.device, p.stiffness_N_per_m, p.damping_Ns_per_m};
}

/// Holm (1979): the i-th smallest of n is multiplied by n - i, never less than its predecessor.
void adjust(std::vector<PointChange>& changes) {
  std::vector<std::size_t> order(changes.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return changes[a].p_value < changes[b].p_value; });
  double floor = 0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    floor = std::max(floor, std::min(1.0, changes[order[i]].p_value * static_cast<double>(order.size() - i)));
    changes[order[i]].adjusted_p = floor;
  }
}

std::string brief(const std::string& text) {
  return text.size() > 60 ? text.substr(0, 57) + "..." : text;
}

}  // namespace

double PointChange::difference() const {
  return static_cast<double>(new_stable) / static_cast<double>(std::max<std::uint64_t>(1, new_arms)) -
         static_cast<double>(old_stable) / static_cast<double>(std::max<std::uint64_t>(1, old_arms));
}

std::size_t SweepComparison::regressions() const {
  return static_cast<std::size_t>(std::count_if(
      changes.begin(), changes.end(), [](const PointChange& c) { return c.significant() && c.difference() < 0; }));
}

std::size_t SweepComparison::improvements() const {
  return static_cast<std::size_t>(std::count_if(
      changes.begin(), changes.end(), [](const PointChange& c) { return c.significant() && c.difference() > 0; }));
}

SweepComparison compare_sweeps(SweepStore& old_sweep, SweepStore& new_sweep) {
  SweepComparison result;
  result.old_name = old_sweep.path().string();
  const SweepIdentity was = old_sweep.identity(), is = new_sweep.identity();
  for (const auto& [setting, value] : is) {
    const auto found = was.find(setting);
    const std::string before = found == was.end() ? "" : found->second;
    if (before == value) continue;
    result.settings.push_back(setting == "scenario"
                                  ? "scenario: changed"
                                  : fmt::format("{}: {} -> {}", setting, brief(before), brief(value)));
  }
  const auto same = [&](const char* setting) {
    return was.contains(setting) && is.contains(setting) && was.at(setting) == is.at(setting);
  };
  const bool same_arms = same("seed") && same("arms") && same("percentiles");

  const auto old_conditions = old_sweep.conditions(), new_conditions = new_sweep.conditions();
  const auto old_points = old_sweep.points(), new_points = new_sweep.points();
  const auto old_cells = old_sweep.cells(), new_cells = new_sweep.cells();
  std::map<Key, std::uint32_t> places;
  for (std::uint32_t p = 0; p < old_points.size(); ++p)
    places[key_of(old_conditions[old_points[p].condition], old_points[p])] = p;
  constexpr std::size_t kDisk = 4;
  static_assert(kSweepMargins[kDisk] == "disk_alpha");
  for (std::uint32_t p = 0; p < new_points.size(); ++p) {
    const SweepCondition& condition = new_conditions[new_points[p].condition];
    const auto found = places.find(key_of(condition, new_points[p]));
    if (found == places.end()) {
      ++result.only_new;
      continue;
    }
    const PointStatistics &before = old_cells[found->second], &after = new_cells[p];
    PointChange change{condition, new_points[p], before.stable, before.arms, after.stable, after.arms};
    change.old_disk_p05 = before.margins[kDisk].p05;
    change.new_disk_p05 = after.margins[kDisk].p05;
    if (same_arms) {
      const std::vector<bool> then = old_sweep.stable_arms(found->second), now = new_sweep.stable_arms(p);
      if (!then.empty() && then.size() == now.size()) {
        change.paired = true;
        for (std::size_t a = 0; a < now.size(); ++a) {
          change.lost += then[a] && !now[a];
          change.won += !then[a] && now[a];
        }
      }
    }
    change.p_value = change.paired ? mcnemar_p_value(change.lost, change.won)
                                   : fisher_p_value(before.stable, before.arms, after.stable, after.arms);
    result.changes.push_back(change);
  }
  result.only_old = old_points.size() - result.changes.size();
  adjust(result.changes);
  return result;
}

std::string SweepComparison::text() const {
  std::string text = fmt::format("compared with {}: {} points in both", old_name, changes.size());
  if (only_old) text += fmt::format(", {} only there", only_old);
  if (only_new) text += fmt::format(", {} only here", only_new);
  text += "\n";
  for (const std::string& line : settings) text += "  " + line + "\n";
  if (changes.empty()) return text + "  no point in common: nothing can be said\n";
  const std::size_t worse = regressions(), better = improvements();
  text +=
      fmt::format("  significantly fewer stable arms at {} points, more at {} (Holm-corrected, 5 %)\n", worse, better);
  std::vector<const PointChange*> listed;
  for (const PointChange& change : changes)
    if (change.significant() || change.old_stable * change.new_arms != change.new_stable * change.old_arms)
      listed.push_back(&change);
  std::stable_sort(listed.begin(), listed.end(), [](auto a, auto b) { return a->difference() < b->difference(); });
  constexpr std::size_t kMost = 12;
  for (std::size_t i = 0; i < listed.size() && i < kMost; ++i) {
    const PointChange& c = *listed[i];
    text +=
        fmt::format("  {}: {} of {} -> {} of {} stable, p = {:.2g}{}\n", describe_point(c.condition, c.point),
                    c.old_stable, c.old_arms, c.new_stable, c.new_arms, c.adjusted_p,
                    c.significant() ? (c.difference() < 0 ? ", a regression" : ", an improvement") : ", may be chance");
  }
  if (listed.size() > kMost) text += fmt::format("  ... and {} more\n", listed.size() - kMost);
  if (listed.empty()) text += "  every verdict is the same\n";
  return text;
}

std::filesystem::path sweep_database_path(const std::filesystem::path& given) {
  return std::filesystem::is_directory(given) ? given / "sweep.sqlite" : given;
}

}  // namespace handloop::studies
