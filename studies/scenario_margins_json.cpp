#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "studies/margins_json.h"
#include "studies/scenario_margins.h"

namespace handloop::studies {
namespace {

using nlohmann::ordered_json;

ordered_json to_json(const models::ArmParameters& arm) {
  ordered_json j;
  const auto values = models::to_array(arm);
  for (std::size_t i = 0; i < values.size(); ++i) j[std::string(models::kArmParameterNames[i])] = values[i];
  return j;
}

ordered_json to_json(const UnstructuredResult& r) {
  return {{"peak", json_number(r.narrow.peak)},
          {"f_Hz", json_number(r.narrow.frequency_Hz)},
          {"peak_0p01_400", json_number(r.wide.peak)},
          {"f_wide_Hz", json_number(r.wide.frequency_Hz)},
          {"robust", r.robust},
          {"robust_wide", r.robust_wide}};
}

ordered_json to_json(const control::StructuredMu& mu) {
  ordered_json j;
  j["upper"] = json_number(mu.upper);
  j["lower"] = json_number(mu.lower);
  j["robust"] = mu.upper < 1;
  j["centre_stable"] = mu.centre_stable;
  j["destabilising_arm"] = mu.destabilising_arm ? to_json(*mu.destabilising_arm) : ordered_json(nullptr);
  j["destabilising_w_rad_per_s"] =
      mu.destabilising_arm ? json_number(mu.destabilising_frequency_rad_per_s) : ordered_json(nullptr);
  return j;
}

/// Margins as a percentile of a population: no frequencies.
ordered_json points(const control::Margins& m) {
  return {{"stable", m.stable},
          {"rho", json_number(m.rho)},
          {"gm_up", json_number(m.gain_up)},
          {"gm_down", json_number(m.gain_down)},
          {"pm_deg", json_number(m.phase_deg)},
          {"dm_s", json_number(m.delay_s)},
          {"sm", json_number(m.modulus)},
          {"disk_alpha", json_number(m.disk_alpha)}};
}

}  // namespace

ordered_json to_json(const ScenarioMargins& r) {
  ordered_json j;
  j["scenario"] = r.scenario.name;
  j["axis"] = models::axis_name(r.axis);
  j["loop"] = {{"tip_mass_kg", r.loop.plant.tip_mass_kg},
               {"tip_damping_Ns_per_m", r.loop.plant.tip_damping_Ns_per_m},
               {"stiffness_N_per_m", r.loop.gains.stiffness_N_per_m},
               {"damping_Ns_per_m", r.loop.gains.damping_Ns_per_m},
               {"sample_time_s", r.loop.timing.sample_time_s},
               {"delay_samples", r.loop.timing.delay_samples},
               {"cutoff_Hz", json_number(r.loop.timing.cutoff_Hz)},
               {"arm", r.loop.plant.arm ? to_json(*r.loop.plant.arm) : ordered_json(nullptr)}};
  j["stable"] = r.nominal.stable;
  j["nominal"] = studies::to_json(r.nominal);
  if (r.without_effects) j["without_effects"] = studies::to_json(*r.without_effects);
  j["critical_stiffness_N_per_m"] = json_number(r.critical_stiffness_N_per_m);
  j["z_width"] = {{"along", {r.loop.gains.stiffness_N_per_m, r.loop.gains.damping_Ns_per_m}},
                  {"factor", json_number(r.ray_limit)}};
  for (const auto axis : models::kAxes) {
    const auto& m = r.by_axis[static_cast<std::size_t>(axis)];
    j["by_axis"][std::string(models::axis_name(axis))] = m ? studies::to_json(*m) : ordered_json(nullptr);
  }
  ordered_json& all = j["all_axes"];
  all["stable"] = r.all_axes.stable;
  all["rho"] = json_number(r.all_axes.rho);
  all["disk_alpha"] = json_number(r.all_axes.disk_alpha);
  all["w_disk_alpha"] = json_number(r.all_axes.disk_at_rad_per_s);
  all["worst_direction"] = {r.all_axes.worst_direction(0), r.all_axes.worst_direction(1),
                            r.all_axes.worst_direction(2)};
  all["worst_direction_name"] = r.all_axes.worst_direction_name;
  for (const double alone : r.all_axes.one_at_a_time) all["one_at_a_time_disk_alpha"].push_back(json_number(alone));
  if (r.maximum) j["robust"] = {{"max", to_json(*r.maximum)}, {"67", to_json(*r.percentile67)}};
  if (r.mu95)
    j["mu"] = {{"percent67", to_json(*r.mu67)}, {"percent95", to_json(*r.mu95)}, {"extremes", to_json(*r.mu_extremes)}};
  const double b = r.device_damping_Ns_per_m;
  j["passivity"] = {{"device_damping_Ns_per_m", b},
                    {"coulomb_N", r.coulomb_N},
                    {"resolution_m", r.resolution_m},
                    {"colgate",
                     {{"required_damping_Ns_per_m", r.required_damping_Ns_per_m},
                      {"passive", b >= r.required_damping_Ns_per_m},
                      {"without_delay",
                       {{"required_damping_Ns_per_m", r.required_damping_no_delay_Ns_per_m},
                        {"passive", b >= r.required_damping_no_delay_Ns_per_m}}}}},
                    {"abbott_okamura",
                     {{"by_damping_N_per_m", json_number(r.abbott_okamura.by_damping)},
                      {"by_friction_N_per_m", json_number(r.abbott_okamura.by_friction)},
                      {"passive", r.loop.gains.stiffness_N_per_m <= r.abbott_okamura.permitted()}}},
                    {"diolaiti",
                     {{"damping_ratio", json_number(r.diolaiti.damping_ratio)},
                      {"damping_suffices", r.diolaiti.damping_suffices},
                      {"friction_ratio", json_number(r.diolaiti.friction_ratio)},
                      {"friction_suffices", r.diolaiti.friction_suffices}}},
                    {"llewellyn",
                     {{"smallest_eta", json_number(r.llewellyn.smallest_eta)},
                      {"w_rad_per_s", json_number(r.llewellyn.at_rad_per_s)},
                      {"absolutely_stable", r.llewellyn.absolutely_stable()}}}};
  if (r.population) {
    const auto& p = *r.population;
    ordered_json& out = j["population"];
    out["arms"] = p.stable.trials;
    out["stable"] = p.stable.successes;
    out["p_stable"] = p.stable.estimate;
    out["p_stable_lo95"] = p.stable.low95;
    out["p_stable_hi95"] = p.stable.high95;
    out["p05"] = points(p.p05);
    out["p50"] = points(p.p50);
    for (const auto& worst : p.worst) {
      ordered_json w;
      w["index"] = worst.index;
      w["arm"] = to_json(worst.arm);
      w["margins"] = studies::to_json(worst.margins);
      out["worst"].push_back(w);
    }
  }
  for (const auto& row : r.permitted) {
    ordered_json p;
    p["key"] = row.key;
    p["test"] = row.test;
    p["assumes"] = row.assumes;
    p["holds"] = row.holds ? ordered_json(*row.holds) : ordered_json(nullptr);
    p["stiffness_N_per_m"] = json_number(row.stiffness_N_per_m);
    j["permitted_stiffness"].push_back(p);
  }
  return j;
}

std::string to_text(const ScenarioMargins& r) {
  std::string out;
  const auto line = [&out](const std::string& text) { out += text + "\n"; };
  const auto& gains = r.loop.gains;
  line(fmt::format(
      "{}: wall on axis {}, K = {:g} N/m, B = {:g} N s/m, T = {:g} ms, {} sample{} of delay; tip {:.1f} g, {:.3g} N "
      "s/m",
      r.scenario.name, models::axis_name(r.axis), gains.stiffness_N_per_m, gains.damping_Ns_per_m,
      1e3 * r.loop.timing.sample_time_s, r.loop.timing.delay_samples, r.loop.timing.delay_samples == 1 ? "" : "s",
      1e3 * r.loop.plant.tip_mass_kg, r.loop.plant.tip_damping_Ns_per_m));
  const auto one = [&line](const std::string& name, const control::Margins& m) {
    if (!m.stable) {
      line(fmt::format("{:<22} UNSTABLE: largest pole modulus {:.9g}", name, m.rho));
      return;
    }
    line(fmt::format(
        "{:<22} gain x {:.4g} up, x {:.4g} down; phase {:.4g} deg{}; delay {:.4g} ms; |1+L| {:.4g}; disk {:.4g}", name,
        m.gain_up, m.gain_down, m.phase_deg,
        std::isnan(m.phase_at_rad_per_s) ? ""
                                         : fmt::format(" at {:.4g} Hz", m.phase_at_rad_per_s / (2 * std::numbers::pi)),
        1e3 * m.delay_s, m.modulus, m.disk_alpha));
  };
  one(r.has_effects ? "nominal, effects in" : "nominal", r.nominal);
  if (r.without_effects) one("without effects", *r.without_effects);
  if (r.all_axes.stable) {
    line(fmt::format("{:<22} disk {:.4g} for all loops at once, weakest along {}", "all axes at once",
                     r.all_axes.disk_alpha, r.all_axes.worst_direction_name));
  } else {
    line(fmt::format("{:<22} UNSTABLE: largest pole modulus {:.9g}", "all axes at once", r.all_axes.rho));
  }
  if (r.population) {
    const auto& p = *r.population;
    line(fmt::format("{:<22} {} of {} arms stable: {:.2f} % (95 % interval {:.2f} to {:.2f} %)", "population",
                     p.stable.successes, p.stable.trials, 100 * p.stable.estimate, 100 * p.stable.low95,
                     100 * p.stable.high95));
    if (p.p05.stable)
      one("  5 % point", p.p05);
    else
      line("  5 % point            none: more than 5 % of the arms are unstable");
  }
  if (r.mu95) {
    line(
        fmt::format("{:<22} 67 % box {:.4g} to {:.4g}; 95 % box {:.4g} to {:.4g}; min to max {:.4g} to {:.4g} (robust "
                    "where below 1)",
                    "structured mu", r.mu67->lower, r.mu67->upper, r.mu95->lower, r.mu95->upper, r.mu_extremes->lower,
                    r.mu_extremes->upper));
  }
  line("");
  line(fmt::format("{:<42} {:<6} {:>10}  {}", "test", "holds", "K up to", "assumes"));
  for (const auto& row : r.permitted) {
    line(
        fmt::format("{:<42} {:<6} {:>10}  {}", row.test, row.holds ? (*row.holds ? "yes" : "no") : "-",
                    std::isnan(row.stiffness_N_per_m) ? std::string("-") : fmt::format("{:.4g}", row.stiffness_N_per_m),
                    row.assumes));
  }
  line(fmt::format("K in N/m with this B. Of 0 a test certifies no wall of 1 N/m or more."));
  return out;
}

}  // namespace handloop::studies
