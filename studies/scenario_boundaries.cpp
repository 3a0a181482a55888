#include "studies/scenario_boundaries.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <numbers>

namespace handloop::studies {
namespace {

std::vector<control::BoundaryPiece> boundary(const control::Loop& loop, const control::GainWindow& window) {
  return control::trace_boundary(control::sample_plant(loop.plant, loop.timing.sample_time_s), loop.timing, window);
}

}  // namespace

control::GainWindow natural_window(const control::Loop& loop) {
  const auto plant = control::sample_plant(loop.plant, loop.timing.sample_time_s);
  // the tongue of stability: the largest K over all B, and the B at which no K is left
  double stiffness = 2 * std::abs(loop.gains.stiffness_N_per_m), damping = 2 * std::abs(loop.gains.damping_Ns_per_m);
  for (double B = 0.01; B < 1e5; B *= 1.2) {
    const double K = control::critical_stiffness(plant, loop.timing, B);
    if (K == 0) break;
    if (!std::isfinite(K)) continue;
    stiffness = std::max(stiffness, 1.1 * K), damping = std::max(damping, 1.25 * B);
  }
  const auto round_up = [](double x) {
    const double decade = std::pow(10.0, std::floor(std::log10(x)));
    return std::ceil(x / decade * 2) / 2 * decade;
  };
  return {0, round_up(std::max(stiffness, 1.0)), 0, round_up(std::max(damping, 0.01))};
}

std::vector<BoundaryFamily> boundary_families(const control::Loop& loop, const models::ArmPopulation& population,
                                              const control::GainWindow& window) {
  std::vector<BoundaryFamily> families;
  families.push_back({"nominal", "This loop", {{0, "this loop", boundary(loop, window)}}});
  const auto family = [&](std::string quantity, std::string title,
                          const std::vector<std::pair<double, std::string>>& values,
                          const std::function<void(control::Loop&, double)>& set) {
    BoundaryFamily f{std::move(quantity), std::move(title), {}};
    for (const auto& [value, label] : values) {
      control::Loop changed = loop;
      set(changed, value);
      f.members.push_back({value, label, boundary(changed, window)});
    }
    families.push_back(std::move(f));
  };
  family("delay_samples", "Delay", {{0, "none"}, {1, "1 sample"}, {2, "2 samples"}, {3, "3 samples"}, {4, "4 samples"}},
         [](control::Loop& l, double d) { l.timing.delay_samples = static_cast<int>(d); });
  std::vector<std::pair<double, std::string>> periods;
  for (const double T : {0.00025, 0.0005, 0.001, 0.002, 0.004})
    periods.emplace_back(T, fmt::format("{:g} ms", 1e3 * T));
  family("sample_time_s", "Sampling period", periods, [](control::Loop& l, double T) { l.timing.sample_time_s = T; });
  std::vector<std::pair<double, std::string>> dampings;
  const double b = std::max(loop.plant.tip_damping_Ns_per_m, 1e-3);
  for (const double factor : {0.0, 1.0, 5.0, 20.0})
    dampings.emplace_back(factor * b, fmt::format("b = {:.3g} N s/m", factor * b));
  family("tip_damping_Ns_per_m", "Viscous friction of the device", dampings,
         [](control::Loop& l, double value) { l.plant.tip_damping_Ns_per_m = value; });
  if (!loop.plant.arm) return families;
  constexpr std::array<const char*, 5> kTitles{"Arm: mass", "Arm: k1", "Arm: k2", "Arm: b1", "Arm: b2"};
  constexpr std::array<const char*, 5> kUnits{"kg", "N/m", "N/m", "N s/m", "N s/m"};
  for (std::size_t i = 0; i < 5; ++i) {
    std::vector<std::pair<double, std::string>> values;
    for (const double p : {0.0, 0.05, 0.5, 0.95, 1.0}) {
      const double value = population.parameter(i).quantile(p);
      values.emplace_back(value, fmt::format("{:.3g} {} ({:g} %)", value, kUnits[i], 100 * p));
    }
    family(std::string(models::kArmParameterNames[i]), kTitles[i], values, [i](control::Loop& l, double value) {
      auto arm = models::to_array(*l.plant.arm);
      arm[i] = value;
      l.plant.arm = models::arm_from_array(arm);
    });
  }
  return families;
}

std::string boundaries_csv(const std::vector<BoundaryFamily>& families) {
  std::string csv = "family,value,piece,stiffness_N_per_m,damping_Ns_per_m,frequency_Hz\n";
  for (const auto& family : families) {
    for (const auto& member : family.members) {
      for (std::size_t piece = 0; piece < member.pieces.size(); ++piece) {
        for (const auto& p : member.pieces[piece].points) {
          fmt::format_to(std::back_inserter(csv), "{},{},{},{},{},{}\n", family.quantity, member.value, piece,
                         p.stiffness_N_per_m, p.damping_Ns_per_m, p.frequency_rad_per_s / (2 * std::numbers::pi));
        }
      }
    }
  }
  return csv;
}

}  // namespace handloop::studies
