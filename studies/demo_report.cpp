#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>
#include <numbers>

#include "io/output.h"
#include "io/report.h"
#include "models/arm_population.h"
#include "studies/arm_bode.h"
#include "studies/arm_sampling.h"
#include "studies/demo.h"
#include "studies/margins_json.h"

namespace handloop::studies {
namespace {

using io::Colour;
using io::Figure;
using io::Plot;
using io::Report;
using io::Series;

std::string percent(double share) {
  return fmt::format("{:.1f} %", 100 * share);
}

std::string factor(double gain) {
  return std::isfinite(gain) ? fmt::format("{:.2f}", gain) : "no limit";
}

std::string hertz(double rad_per_s) {
  return fmt::format("at {:.1f} Hz", rad_per_s / (2 * std::numbers::pi));
}

std::vector<double> scaled(std::vector<double> values, double by) {
  for (double& v : values) v *= by;
  return values;
}

std::string title_of(models::Axis axis) {
  constexpr std::array words{"X, left-right", "Y, up-down", "Z, forward-backward"};
  return words[static_cast<std::size_t>(axis)];
}

// ---- in short -------------------------------------------------------------------------------------------------------

std::vector<Figure> headlines(const Demo& demo) {
  const auto& axis = demo.wall_axis();
  const auto& m = axis.nominal;
  const auto mood = [](bool good) { return good ? Figure::Mood::good : Figure::Mood::bad; };
  std::vector<Figure> figures{
      {"nominal arm", m.stable ? "stable" : "unstable", fmt::format("largest pole {:.4f}", m.rho), mood(m.stable)}};
  if (m.stable) {
    figures.push_back({"gain margin", factor(m.gain_up), "spring and damper together"});
    figures.push_back({"phase margin", fmt::format("{:.0f} deg", std::abs(m.phase_deg)), hertz(m.phase_at_rad_per_s)});
  }
  figures.push_back({"stiffest stable wall", fmt::format("{:.0f} N/m", axis.critical_stiffness_N_per_m),
                     fmt::format("at {} N s/m", demo.scenario.loop.damping_Ns_per_m)});
  figures.push_back({"arms that stay stable", percent(axis.population.stable.estimate),
                     fmt::format("{} sampled; 95 %: {} to {}", demo.options.arms, percent(axis.population.stable.low95),
                                 percent(axis.population.stable.high95)),
                     mood(axis.population.stable.estimate > 0.95)});
  figures.push_back({"stiffest wall for 95 % of arms", fmt::format("{:.0f} N/m", axis.permitted_stiffness_N_per_m),
                     fmt::format("this one has {}", demo.scenario.loop.stiffness_N_per_m)});
  return figures;
}

// ---- closed loop ----------------------------------------------------------------------------------------------------

Plot position_plot(const LoopTrace& trace) {
  Plot plot{.x_label = "time / s", .y_label = "tip beyond the wall / mm"};
  plot.series.push_back(
      {.label = "tip, from the encoders", .x = trace.t_s, .y = scaled(trace.position_m, 1e3), .colour = Colour::blue});
  plot.horizontal = {{0, "wall"}};
  if (!trace.fault.empty()) plot.vertical = {{trace.fault_at_s, "safety stop", Colour::orange}};
  plot.height_px = 280;
  return plot;
}

Plot force_plot(const LoopTrace& trace) {
  Plot plot{.x_label = "time / s", .y_label = "force / N"};
  plot.series.push_back({.label = "on the hand, as sensed",
                         .x = trace.t_s,
                         .y = trace.hand_force_N,
                         .colour = Colour::grey,
                         .width = 1.0});
  plot.series.push_back({.label = "of the wall, as written to the motors",
                         .x = trace.t_s,
                         .y = trace.wall_force_N,
                         .colour = Colour::orange});
  if (!trace.fault.empty()) plot.vertical = {{trace.fault_at_s, "safety stop", Colour::orange}};
  plot.height_px = 280;
  return plot;
}

void add_closed_loop(Report& report, const Demo& demo) {
  const auto& s = demo.scenario;
  report.section("The closed loop");
  report.paragraph(fmt::format(
      "A hand pushes the stylus with {} N along {} into a virtual wall of **{} N/m** and **{} N s/m**. The controller "
      "sees encoder counts and writes DAC codes, {:g} kHz, {} sample of delay; the device, its motors and the arm that "
      "holds it are simulated in MuJoCo. The arm's own springs take up the rest of the push.",
      s.hand.push_N, title_of(s.wall.axis), s.loop.stiffness_N_per_m, s.loop.damping_Ns_per_m,
      1e-3 / s.loop.sample_time_s, s.loop.delay_samples));
  report.plot(position_plot(demo.wall)).plot(force_plot(demo.wall));
  if (!demo.wall.fault.empty()) {
    report.callout(Report::Tone::warning,
                   fmt::format("The run ended after {:.3f} s: {}.", demo.wall.fault_at_s, demo.wall.fault));
  }
  report.section("Beyond the margin");
  report.paragraph(fmt::format(
      "The same loop as a spring of **{:.0f} N/m** that acts on both sides, 20 % beyond the limit that the margins "
      "predict ({:.0f} N/m): the hand now starts an oscillation that grows.",
      demo.beyond_stiffness_N_per_m, demo.wall_axis().critical_stiffness_N_per_m));
  report.plot(position_plot(demo.beyond));
  report.plot(force_plot(demo.beyond), demo.beyond.fault.empty()
                                           ? "It stays within the safety limits for as long as was simulated."
                                           : fmt::format("The safety envelope ends it after {:.3f} s: {}.",
                                                         demo.beyond.fault_at_s, demo.beyond.fault));
}

// ---- margins --------------------------------------------------------------------------------------------------------

io::Table margins_table(const Demo& demo) {
  io::Table table{
      .columns = {"", "gain margin", "phase margin / deg", "disk margin", "stiffest wall / N/m", "stable arms (95 %)"}};
  for (const auto& a : demo.axes) {
    const auto& m = a.nominal;
    const auto name = title_of(a.axis);
    table.rows.push_back({fmt::format("{}: nominal arm", name.substr(0, 1)), m.stable ? factor(m.gain_up) : "unstable",
                          m.stable ? fmt::format("{:.1f}", std::abs(m.phase_deg)) : "",
                          m.stable ? fmt::format("{:.2f}", m.disk_alpha) : "",
                          fmt::format("{:.0f}", a.critical_stiffness_N_per_m), ""});
    table.rows.push_back(
        {"95 % of arms, at least", factor(a.population.p05.gain_up), fmt::format("{:.1f}", a.population.p05.phase_deg),
         fmt::format("{:.2f}", a.population.p05.disk_alpha), fmt::format("{:.0f}", a.permitted_stiffness_N_per_m),
         fmt::format("{} ({} to {})", percent(a.population.stable.estimate), percent(a.population.stable.low95),
                     percent(a.population.stable.high95))});
  }
  table.caption = fmt::format(
      "Nominal arm of Table II and {} arms sampled from Table III, with the scenario's wall on each axis. The gain "
      "margin "
      "scales spring and damper together; the stiffest wall keeps the damper. Tip masses {:.0f}, {:.0f} and {:.0f} g.",
      demo.options.arms, 1e3 * demo.axes[0].loop.plant.tip_mass_kg, 1e3 * demo.axes[1].loop.plant.tip_mass_kg,
      1e3 * demo.axes[2].loop.plant.tip_mass_kg);
  return table;
}

Plot map_plot(const Demo& demo) {
  const auto& map = demo.map;
  Plot plot{.x_label = "wall stiffness / N/m", .y_label = "wall damping / N s/m"};
  plot.heat_map = io::HeatMap{.x = map.stiffness_N_per_m,
                              .y = map.damping_Ns_per_m,
                              .value = scaled(map.stable_share, 100),
                              .label = "stable arms / %",
                              .range = {{0.0, 100.0}},
                              .contours = {5, 50, 95}};
  bool first = true;
  for (const auto& piece : map.nominal_boundary) {
    Series line{.label = first ? "limit of the nominal arm" : "", .colour = Colour::ink, .width = 2.2};
    for (const auto& p : piece.points) {
      line.x.push_back(p.stiffness_N_per_m);
      line.y.push_back(p.damping_Ns_per_m);
    }
    plot.series.push_back(line);
    first = false;
  }
  plot.series.push_back({.label = "this wall",
                         .x = {demo.scenario.loop.stiffness_N_per_m},
                         .y = {demo.scenario.loop.damping_Ns_per_m},
                         .style = Series::Style::points,
                         .colour = Colour::orange});
  plot.x_range = {{0, map.stiffness_N_per_m.back()}};
  plot.y_range = {{0, map.damping_Ns_per_m.back()}};
  plot.height_px = 460;
  return plot;
}

Plot stiffest_wall_plot(const Demo& demo) {
  const auto& axis = demo.wall_axis();
  std::vector<double> walls;
  for (const double k : axis.sampled_critical_N_per_m) {
    if (std::isfinite(k)) walls.push_back(k);
  }
  Plot plot{.x_label = "stiffest stable wall / N/m", .y_label = "sampled arms"};
  if (walls.empty()) return plot;
  plot.series.push_back(io::histogram(walls, 40, ""));
  plot.vertical = {{axis.permitted_stiffness_N_per_m, "5 %", Colour::orange},
                   {axis.critical_stiffness_N_per_m, "nominal", Colour::ink}};
  plot.height_px = 280;
  return plot;
}

void add_margins(Report& report, const Demo& demo) {
  report.section("Stability margins");
  report.paragraph("Exact for the sampled loop: zero-order hold, delay and the damper's filter included.");
  report.table(margins_table(demo));
  report.plot(map_plot(demo),
              fmt::format("Axis {}: which walls are stable, for the nominal arm (line) and for what share of the "
                          "sampled arms (colour).",
                          title_of(demo.scenario.wall.axis)));
  report.plot(stiffest_wall_plot(demo), fmt::format("How much the stiffest wall at {} N s/m differs from arm to arm.",
                                                    demo.scenario.loop.damping_Ns_per_m));
}

// ---- arms -----------------------------------------------------------------------------------------------------------

void add_arms(Report& report, const Demo& demo) {
  report.section("The arms");
  report.paragraph(
      "Frequency response from force to position at the grip: 100 arms drawn from the measured population "
      "before the published ones.");
  for (const auto axis : models::kAxes) {
    const models::ArmPopulation population(axis);
    auto plots = bode_plots(arm_bode(population, {300, demo.options.seed, {}}));
    for (auto& plot : plots) plot.width_px = 620, plot.height_px = 400;
    report.subsection(title_of(axis));
    report.plots(std::move(plots));
  }
}

void add_assumptions(Report& report) {
  report.section("What this rests on");
  const models::ArmPopulation population(models::Axis::x);
  report.list(
      {"Arms: Tables I to III of Fu and Cavusoglu (2012), stylus grip, identified from 0.6 to 30 Hz.",
       "Population: " + population_assumptions(population) + ".",
       "Device: Phantom Premium 1.5, parameter set \"cavusoglu\", 52 g of stylus and gimbal; its joint friction and "
       "structural resonance were never published and are switched off unless a scenario sets them.",
       "No stability boundary measured on hardware stands behind these margins."});
}

std::string csv_of(const LoopTrace& trace) {
  fmt::memory_buffer rows;
  const auto out = std::back_inserter(rows);
  fmt::format_to(out, "time_s,position_m,wall_force_N,hand_force_N\n");
  for (std::size_t i = 0; i < trace.t_s.size(); ++i) {
    fmt::format_to(out, "{},{},{},{}\n", trace.t_s[i], trace.position_m[i], trace.wall_force_N[i],
                   trace.hand_force_N[i]);
  }
  return fmt::to_string(rows);
}

nlohmann::ordered_json summary(const Demo& demo) {
  nlohmann::ordered_json json{
      {"scenario", demo.scenario.name}, {"arms", demo.options.arms}, {"seed", demo.options.seed}};
  json["run"] = {{"fault", demo.wall.fault}};
  json["beyond"] = {{"stiffness_N_per_m", demo.beyond_stiffness_N_per_m},
                    {"fault", demo.beyond.fault},
                    {"fault_at_s", demo.beyond.fault_at_s}};
  for (const auto& a : demo.axes) {
    json["margins"][std::string(axis_name(a.axis))] = {
        {"tip_mass_kg", a.loop.plant.tip_mass_kg},
        {"nominal", to_json(a.nominal)},
        {"critical_stiffness_N_per_m", json_number(a.critical_stiffness_N_per_m)},
        {"permitted_stiffness_95_N_per_m", json_number(a.permitted_stiffness_N_per_m)},
        {"p_stable", a.population.stable.estimate},
        {"p_stable_95", {a.population.stable.low95, a.population.stable.high95}},
        {"gm_up_p05", json_number(a.population.p05.gain_up)},
        {"pm_deg_p05", json_number(a.population.p05.phase_deg)},
        {"disk_alpha_p05", json_number(a.population.p05.disk_alpha)}};
  }
  return json;
}

}  // namespace

void write_demo(const Demo& demo, const std::filesystem::path& directory) {
  io::OutputDirectory output(directory);
  Report report("A held Phantom at a virtual wall", demo.scenario.description);
  report.section("In short").figures(headlines(demo));
  add_closed_loop(report, demo);
  add_margins(report, demo);
  add_arms(report, demo);
  add_assumptions(report);
  report.write(output / "report.html");
  write_json(summary(demo), (output / "summary.json").string());
  io::write_file_atomically(output / "closed_loop.csv", csv_of(demo.wall));
  output.commit();
}

}  // namespace handloop::studies
