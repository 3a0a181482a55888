#include <fmt/format.h>

#include "io/scenario_file.h"
#include "studies/sweep_store.h"

namespace handloop::studies {
namespace {

/// Raised whenever the same settings would give other rows: databases of another version are refused.
constexpr int kFormatVersion = 1;

std::string words(const GainRange& range) {
  return fmt::format("{:.17g}:{:.17g}:{}{}", range.low, range.high, range.count, range.logarithmic ? ":log" : "");
}

}  // namespace

SweepIdentity sweep_identity(const SweepSettings& s) {
  std::string axes, delays;
  for (const SweepCondition& c : sweep_conditions(s)) {
    const std::string axis(models::axis_name(c.axis)), delay = std::to_string(c.delay_samples);
    if (axes.find(axis) == std::string::npos) axes += (axes.empty() ? "" : ",") + axis;
    if ((',' + delays + ',').find(',' + delay + ',') == std::string::npos)
      delays += (delays.empty() ? "" : ",") + delay;
  }
  return {{"format_version", std::to_string(kFormatVersion)},
          {"scenario", io::to_toml(s.scenario)},
          {"arms", std::to_string(s.arms)},
          {"gains_k", words(s.stiffness)},
          {"gains_b", words(s.damping)},
          {"method", std::string(sweep_method_name(s.method))},
          {"design", std::string(sweep_design_name(s.design))},
          {"points", s.design == SweepDesign::latin_hypercube ? std::to_string(s.points) : ""},
          {"levels", s.design == SweepDesign::adaptive ? std::to_string(s.levels) : ""},
          {"boundary", s.design == SweepDesign::adaptive ? fmt::format("{:.17g}", s.boundary) : ""},
          {"axes", axes},
          {"delays", delays},
          {"devices", std::to_string(s.devices)},
          {"percentiles", std::string(models::percentile_reading_name(s.percentiles))},
          {"seed", std::to_string(s.seed)},
          {"evaluations", s.keep_evaluations ? "kept" : "not kept"}};
}

}  // namespace handloop::studies
