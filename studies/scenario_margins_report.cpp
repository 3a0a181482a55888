#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>
#include <numbers>

#include "io/model_file.h"
#include "io/output.h"
#include "io/report.h"
#include "studies/margins_json.h"
#include "studies/scenario_boundaries.h"
#include "studies/scenario_margins.h"
#include "studies/stability_plots.h"

namespace handloop::studies {
namespace {

using io::pretty;
constexpr double kTurn = 2 * std::numbers::pi;

std::string hertz(double w) {
  return std::isfinite(w) ? fmt::format("at {:.4g} Hz", w / kTurn) : "";
}

void add_verdict(io::Report& report, const ScenarioMargins& r) {
  using Mood = io::Figure::Mood;
  const auto& m = r.nominal;
  if (!m.stable) {
    report.callout(io::Report::Tone::warning, fmt::format("**Unstable.** The closed loop has a pole of modulus {:.9g}. "
                                                          "An unstable loop has no margins; none are shown.",
                                                          m.rho));
    return;
  }
  const auto mood = [](bool good) { return good ? Mood::good : Mood::bad; };
  const auto disk = control::disk_guarantee(m.disk_alpha);
  report.figures(
      {{"verdict", "stable", fmt::format("largest pole modulus {:.6g}", m.rho), Mood::good},
       {"gain up", "x " + pretty(m.gain_up, 3), hertz(m.gain_up_at_rad_per_s), mood(m.gain_up > 2)},
       {"phase", pretty(m.phase_deg, 3) + " deg", hertz(m.phase_at_rad_per_s), mood(std::abs(m.phase_deg) > 30)},
       {"delay", pretty(1e3 * m.delay_s, 3) + " ms", hertz(m.delay_at_rad_per_s)},
       {"modulus", pretty(m.modulus, 3), hertz(m.modulus_at_rad_per_s), mood(m.modulus > 0.5)},
       {"disk", pretty(m.disk_alpha, 3),
        fmt::format("gain x {} to {}, phase +-{} deg at once", pretty(disk.gain_low, 3), pretty(disk.gain_high, 3),
                    pretty(disk.phase_deg, 3)),
        mood(m.disk_alpha > 0.5)}});
}

io::Table permitted_table(const ScenarioMargins& r) {
  io::Table table{{"test", "holds here", "K up to / (N/m)", "assumes"},
                  {},
                  "K with the B that is set; 0: no wall of 1 N/m or more is certified."};
  for (const auto& row : r.permitted) {
    table.rows.push_back(
        {row.test, row.holds ? (*row.holds ? "yes" : "no") : "", pretty(row.stiffness_N_per_m), row.assumes});
  }
  return table;
}

void add_population(io::Report& report, const ScenarioMargins& r, const ScenarioMarginsRequest& request,
                    const models::ArmPopulation& population) {
  const auto& p = *r.population;
  report.section("The population");
  report.callout(
      io::Report::Tone::assumption,
      fmt::format("Arms are drawn from Table III of Fu and Cavusoglu, its ends read as the percentiles of the `{}` "
                  "reading, its five "
                  "parameters independent: no correlation was published. Effects of the scenario are left out of them.",
                  models::percentile_reading_name(request.percentiles)));
  report.paragraph(fmt::format(
      "**{} of {} arms are stable: {:.2f} %**, 95 % interval {:.2f} to {:.2f} % (Clopper and Pearson).",
      p.stable.successes, p.stable.trials, 100 * p.stable.estimate, 100 * p.stable.low95, 100 * p.stable.high95));
  io::Table points{{"margin", "nominal", "half of the arms", "5 % of the arms fall below"},
                   {},
                   "Unstable arms count as having no margin."};
  const auto row = [&](const char* name, double control::Margins::*margin) {
    points.rows.push_back({name, pretty(r.nominal.*margin), pretty(p.p50.*margin), pretty(p.p05.*margin)});
  };
  row("gain up", &control::Margins::gain_up);
  row("gain down (rises above)", &control::Margins::gain_down);
  row("phase / deg", &control::Margins::phase_deg);
  row("delay / s", &control::Margins::delay_s);
  row("modulus", &control::Margins::modulus);
  row("disk", &control::Margins::disk_alpha);
  report.table(points);
  report.plots({population_plot(p, r.nominal.stable ? r.nominal.disk_alpha : std::nan("")),
                share_plot(population, r.loop, std::min<std::size_t>(request.arms, 1000), request.seed)});
  io::Table worst{{"file", "stable", "pole modulus", "disk", "M / kg", "k1", "k2", "b1", "b2"},
                  {},
                  "The worst arms, as model files."};
  for (std::size_t i = 0; i < p.worst.size(); ++i) {
    const auto& w = p.worst[i];
    std::vector<std::string> cells{fmt::format("worst_arm_{}.toml", i + 1), w.margins.stable ? "yes" : "no",
                                   pretty(w.margins.rho, 7), pretty(w.margins.disk_alpha)};
    for (const double value : models::to_array(w.arm)) cells.push_back(pretty(value));
    worst.rows.push_back(std::move(cells));
  }
  report.table(worst);
}

}  // namespace

void write_scenario_margins(const ScenarioMargins& r, const ScenarioMarginsRequest& request,
                            const std::string& directory) {
  io::OutputDirectory out(directory);
  const models::ArmPopulation population(r.axis, request.percentiles);
  const auto window = natural_window(r.loop);
  const auto families = boundary_families(r.loop, population, window);
  const auto curve = loop_curve(r.loop);

  io::Report report(
      "Stability of " + r.scenario.name,
      fmt::format("wall on axis {}, K = {:g} N/m, B = {:g} N s/m, T = {:g} ms, {} samples of delay",
                  models::axis_name(r.axis), r.loop.gains.stiffness_N_per_m, r.loop.gains.damping_Ns_per_m,
                  1e3 * r.loop.timing.sample_time_s, r.loop.timing.delay_samples));
  report.section("Verdict");
  add_verdict(report, r);
  if (r.has_effects) {
    report.paragraph(fmt::format(
        "These margins include the scenario's effects by their linear forms. Without them: {}.",
        r.without_effects->stable ? fmt::format("stable, disk margin {}", pretty(r.without_effects->disk_alpha))
                                  : "unstable"));
  }
  report.paragraph(
      fmt::format("Tip {:.1f} g and {:.3g} N s/m at the pose. Critical stiffness with this B: **{} N/m**. Along the "
                  "ray of these gains the loop "
                  "is stable up to **{} times** (K, B).",
                  1e3 * r.loop.plant.tip_mass_kg, r.loop.plant.tip_damping_Ns_per_m,
                  pretty(r.critical_stiffness_N_per_m), pretty(r.ray_limit)));
  report.section("The loop");
  report.plots(bode_plots(curve, r.nominal), r.has_effects ? "Drawn without the effects." : "");
  report.plots({nyquist_plot(curve, r.nominal), sensitivity_plot(curve, r.nominal)});
  report.section("All axes at once");
  if (r.all_axes.stable) {
    report.paragraph(fmt::format(
        "The same wall on all three axes, coupled by the device's inertia at the pose: multi-loop disk margin **{}** "
        "at {:.4g} Hz, "
        "weakest along **{}**. Each loop alone, the others closed: x {}, y {}, z {}.",
        pretty(r.all_axes.disk_alpha), r.all_axes.disk_at_rad_per_s / kTurn, r.all_axes.worst_direction_name,
        pretty(r.all_axes.one_at_a_time[0]), pretty(r.all_axes.one_at_a_time[1]), pretty(r.all_axes.one_at_a_time[2])));
  } else {
    report.callout(io::Report::Tone::warning,
                   fmt::format("The same wall on all three axes is unstable: pole modulus {:.7g}.", r.all_axes.rho));
  }
  report.section("What each test permits");
  report.paragraph(
      "Every test asks whether the wall is stable, each for another idea of who may hold the device. The more a test "
      "admits, the softer the "
      "wall that it certifies.");
  report.table(permitted_table(r));
  if (r.mu95) {
    io::Table mu{
        {"box of Table III", "mu at least", "mu at most", "robust", "arm that destabilises, at the stretch 1/mu"},
        {},
        ""};
    for (const auto& [name, m] :
         {std::pair{"67 %", r.mu67}, std::pair{"95 %", r.mu95}, std::pair{"minimum to maximum", r.mu_extremes}}) {
      std::string arm;
      if (m->destabilising_arm) {
        const auto& a = *m->destabilising_arm;
        arm = fmt::format("M {}, k1 {}, k2 {}, b1 {}, b2 {}; rings at {:.4g} Hz", pretty(a.mass_kg),
                          pretty(a.k1_N_per_m), pretty(a.k2_N_per_m), pretty(a.b1_Ns_per_m), pretty(a.b2_Ns_per_m),
                          m->destabilising_frequency_rad_per_s / kTurn);
      }
      mu.rows.push_back({name, pretty(m->lower), pretty(m->upper), m->upper < 1 ? "yes" : "not shown", arm});
    }
    report.subsection("Structured: five real parameters");
    report.table(mu);
    report.subsection("Unstructured: |W_u T|");
    report.table(
        {{"envelope", "peak 0.6 to 30 Hz", "at / Hz", "peak 0.01 to 400 Hz", "at / Hz", "robust"},
         {{"67 %", pretty(r.percentile67->narrow.peak), pretty(r.percentile67->narrow.frequency_Hz),
           pretty(r.percentile67->wide.peak), pretty(r.percentile67->wide.frequency_Hz),
           r.percentile67->robust ? "yes" : "no"},
          {"maximum", pretty(r.maximum->narrow.peak), pretty(r.maximum->narrow.frequency_Hz),
           pretty(r.maximum->wide.peak), pretty(r.maximum->wide.frequency_Hz), r.maximum->robust ? "yes" : "no"}},
         "The envelope was identified from 0.6 to 30 Hz; beyond, it extrapolates."});
  }
  report.subsection("Passivity: whoever holds it");
  report.table({{"condition", "needs", "has"},
                {{"Colgate and Schenkel, this delay", pretty(r.required_damping_Ns_per_m) + " N s/m",
                  pretty(r.device_damping_Ns_per_m) + " N s/m"},
                 {"Colgate and Schenkel, no delay", pretty(r.required_damping_no_delay_Ns_per_m) + " N s/m",
                  pretty(r.device_damping_Ns_per_m) + " N s/m"},
                 {"Diolaiti: sampling and delay, b/(KT)", pretty(0.5 + r.loop.timing.delay_samples),
                  pretty(r.diolaiti.damping_ratio)},
                 {"Diolaiti: quantisation, c/(K Delta)", "0.5", pretty(r.diolaiti.friction_ratio)},
                 {"Llewellyn, smallest eta", "1", pretty(r.llewellyn.smallest_eta)}},
                fmt::format("At the tip along the axis: Coulomb friction {} N, encoder step {} mm.",
                            pretty(r.coulomb_N), pretty(1e3 * r.resolution_m))});
  report.section("The K-B map");
  control::GainWindow near = window;
  near.damping_high =
      std::min(window.damping_high, std::max(4 * r.loop.gains.damping_Ns_per_m, 0.03 * window.damping_high));
  near.stiffness_high = 0;
  for (const auto& piece : families.front().members.front().pieces) {
    for (const auto& p : piece.points) {
      if (p.damping_Ns_per_m <= near.damping_high)
        near.stiffness_high = std::max(near.stiffness_high, 1.15 * p.stiffness_N_per_m);
    }
  }
  near.stiffness_high = std::max(near.stiffness_high, 1.2 * r.loop.gains.stiffness_N_per_m);
  auto whole_map = map_plot(families.front(), window, r.loop.gains),
       near_map = map_plot(families.front(), near, r.loop.gains);
  whole_map.title = "All of it";
  near_map.title = "About the gains";
  report.plots({whole_map, near_map},
               "Stable below the curve. Traced, not filled: on the curve a pole pair rings at the frequency in "
               "`boundaries.csv`.");
  std::vector<io::Plot> maps;
  for (std::size_t i = 1; i < families.size(); ++i) {
    auto plot = map_plot(families[i], window, r.loop.gains);
    plot.width_px = 560;
    plot.height_px = 360;
    maps.push_back(std::move(plot));
  }
  report.plots(std::move(maps), "How the boundary moves with one quantity, the others as they are.");
  if (r.population) add_population(report, r, request, population);

  io::write_file_atomically(out / "margins.json", to_json(r).dump(2) + "\n");
  io::write_file_atomically(out / "boundaries.csv", boundaries_csv(families));
  std::string response = "frequency_Hz,loop_re,loop_im\n";
  for (std::size_t i = 0; i < curve.loop.size(); ++i) {
    fmt::format_to(std::back_inserter(response), "{},{},{}\n", curve.frequency_Hz[i], curve.loop[i].real(),
                   curve.loop[i].imag());
  }
  io::write_file_atomically(out / "loop_response.csv", response);
  if (r.population) {
    std::string table = "arm,disk_alpha\n";
    for (std::size_t i = 0; i < r.population->disk_alpha.size(); ++i)
      fmt::format_to(std::back_inserter(table), "{},{}\n", i, r.population->disk_alpha[i]);
    io::write_file_atomically(out / "population.csv", table);
    for (std::size_t i = 0; i < r.population->worst.size(); ++i) {
      models::AxisModel model;
      model.axis = r.axis;
      model.arm = r.population->worst[i].arm;
      io::write_model(out / fmt::format("worst_arm_{}.toml", i + 1), model);
    }
  }
  if (r.mu95 && r.mu95->destabilising_arm) {
    models::AxisModel model;
    model.axis = r.axis;
    model.arm = *r.mu95->destabilising_arm;
    io::write_model(out / "destabilising_arm.toml", model);
  }
  report.write(out / "report.html");
  out.commit();
}

}  // namespace handloop::studies
