#include "studies/explain_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "identify/spectra.h"
#include "models/effects/tabulated.h"

namespace handloop::studies {
namespace {

using identify::Explanation;
using identify::Verdict;
using io::Figure;
using io::Plot;
using io::pretty;
using io::Series;

std::string unit_of(const ExplainStudy& study) {
  return study.options.driven_by == identify::DrivenBy::force ? study.recording.position_unit
                                                              : study.recording.force_unit;
}

std::string spoken(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

std::string names_of(const Explanation& e) {
  std::string names;
  for (const auto& effect : e.effects) names.append(names.empty() ? "" : " and ").append(spoken(effect.name));
  return names;
}

std::string headline(const Explanation& e) {
  if (e.verdict == Verdict::no_effect) return "The base model lacks nothing that this recording can show.";
  if (e.verdict == Verdict::effect_added) return "The model lacked **" + names_of(e) + "**.";
  if (e.effects.empty())
    return "The residual has structure that no catalogued effect explains; it is tabulated and has no name.";
  return "**" + names_of(e) +
         "** helps, but structure is left that no catalogued effect explains; it is tabulated and has no name.";
}

void margins_section(io::Report& report, const ExplainOutcome& outcome) {
  const auto& m = outcome.margins;
  report.section("What it does to the wall");
  if (!m.before || !m.after) {
    report.paragraph(
        "No wall loop is closed over this plant (rotary, or not to be linearised), so no margin is stated.");
    return;
  }
  const auto verdict = [](const control::Margins& margins) { return margins.stable ? "STABLE" : "UNSTABLE"; };
  const auto number = [](const control::Margins& margins, double value) {
    return margins.stable ? pretty(value, 4) : std::string("–");
  };
  report.table(
      {{"", "before", "after"},
       {{"verdict", verdict(*m.before), verdict(*m.after)},
        {"gain margin", number(*m.before, m.before->gain_up), number(*m.after, m.after->gain_up)},
        {"phase margin, deg", number(*m.before, m.before->phase_deg), number(*m.after, m.after->phase_deg)},
        {"delay margin, s", number(*m.before, m.before->delay_s), number(*m.after, m.after->delay_s)},
        {"disk margin", number(*m.before, m.before->disk_alpha), number(*m.after, m.after->disk_alpha)},
        {"stiffest stable wall, N/m", pretty(m.critical_stiffness_before, 4), pretty(m.critical_stiffness_after, 4)}},
       "wall of 400 N/m and 1 Ns/m, 1 ms, one sample of delay, tip of 75 g and 0.05 Ns/m"});
  if (m.critical_stiffness_before > 0 && std::isfinite(m.critical_stiffness_before) &&
      std::isfinite(m.critical_stiffness_after)) {
    const double change = 100 * (m.critical_stiffness_after / m.critical_stiffness_before - 1);
    report.callout(io::Report::Tone::note,
                   std::abs(change) < 0.5
                       ? "The stiffest stable wall stays as it was."
                       : fmt::format("The stiffest stable wall is **{:.0f} % {}** than the base model promised.",
                                     std::abs(change), change < 0 ? "softer" : "stiffer"));
  }
  report.callout(io::Report::Tone::assumption,
                 "Nonlinear effects enter by their describing functions at this recording's amplitude; at another "
                 "amplitude the margins "
                 "differ. `handloop run` with the model file shows the same loop in the time domain.");
}

Plot residual_plot(const ExplainStudy& study, const Explanation& e) {
  const double h = study.recording.sample_time_s;
  const std::size_t n = e.residual_before.size(), from = n * 3 / 5,
                    count = std::min(n - from, static_cast<std::size_t>(4.0 / h));
  Series before{.label = "base model", .colour = io::Colour::orange, .width = 1.2},
      after{.label = "after", .colour = io::Colour::blue, .width = 1.2};
  for (std::size_t i = from; i < from + count; ++i) {
    before.x.push_back(static_cast<double>(i) * h);
    before.y.push_back(e.residual_before[i]);
    after.y.push_back(e.residual_after[i]);
  }
  after.x = before.x;
  return {.title = "Error of the prediction, four seconds held out",
          .x_label = "time, s",
          .y_label = "error, " + unit_of(study),
          .series = {before, after}};
}

Plot spectrum_plot(const ExplainStudy& study, const Explanation& e) {
  const double h = study.recording.sample_time_s;
  const auto settings = identify::long_segment_settings(e.residual_before.size(), h, std::min(60.0, 0.45 / h));
  const auto& input =
      study.options.driven_by == identify::DrivenBy::force ? study.recording.force_N : study.recording.position_m;
  Plot plot{.title = "Spectrum of the error",
            .x_label = "frequency, Hz",
            .y_label = "amplitude density, " + unit_of(study) + "/sqrt(Hz)",
            .log_x = true,
            .log_y = true};
  const auto add = [&](const std::vector<double>& residual, const char* label, io::Colour colour) {
    const auto spectra = identify::welch(input, residual, h, settings);
    Series line{.label = label, .x = spectra.frequency_Hz, .colour = colour};
    for (const double power : spectra.output_power) line.y.push_back(std::sqrt(power));
    plot.series.push_back(line);
  };
  add(e.residual_before, "base model", io::Colour::orange);
  add(e.residual_after, "after", io::Colour::blue);
  return plot;
}

void rest_section(io::Report& report, const ExplainStudy& study, const Explanation& e) {
  if (!e.rest) return;
  using Grid = models::TabulatedGrid;
  report.section("What is left without a name");
  report.paragraph(
      fmt::format("{}. It takes away {:.0f} % of the power of the error that was left on data it has not seen.",
                  e.rest->description, 100 * e.share_of_residual));
  const auto values = e.rest->hypothesis.model.effects.back()->parameters();
  Plot plot{.title = "Tabulated force", .x_label = "displacement, m", .y_label = "velocity, m/s"};
  io::HeatMap map{.label = "force, " + study.recording.force_unit};
  for (const double knot : Grid::kDisplacementKnots) map.x.push_back(values[0] + knot * values[1]);
  for (const double knot : Grid::kVelocityKnots) map.y.push_back(knot * values[2]);
  for (std::size_t j = 0; j < Grid::kVelocities; ++j) {
    for (std::size_t i = 0; i < Grid::kDisplacements; ++i)
      map.value.push_back(values[Grid::kFirstForce + i * Grid::kVelocities + j]);
  }
  plot.heat_map = map;
  report.plot(plot);
}

}  // namespace

io::Report explain_report(const ExplainStudy& study, const ExplainOutcome& outcome) {
  const auto& e = outcome.explanation;
  const std::string unit = unit_of(study);
  const bool force_driven = study.options.driven_by == identify::DrivenBy::force;
  io::Report report("What the model lacks", study.recording.name);
  report.section("Verdict");
  report.callout(e.verdict == Verdict::unexplained_residual ? io::Report::Tone::warning : io::Report::Tone::good,
                 headline(e));
  const double before = e.base.errors.rmse_validation, after = e.after.errors.rmse_validation;
  report.figures(
      {{"error before", pretty(before, 3) + " " + unit, "rms, held out"},
       {"error after", pretty(after, 3) + " " + unit, fmt::format("{:.0f} % less", 100 * (1 - after / before)),
        after < 0.95 * before ? Figure::Mood::good : Figure::Mood::neutral},
       {"noise floor", pretty(e.floor.rmse, 3) + " " + unit, "what no input predicts"},
       {"share of motion", fmt::format("{:.2f} %", 100 * e.after.errors.nrmse_validation),
        fmt::format("error after over the signal; before {:.2f} %", 100 * e.base.errors.nrmse_validation)}});
  report.paragraph(fmt::format(
      "The {} of the {} is predicted from its {} in one free run. {} Errors are quoted on {}. {} variants of the "
      "catalogue's effects competed; {:.1f} s.",
      force_driven ? "position" : "force",
      e.base.model.base == models::BaseModel::arm5 ? "five-parameter arm" : "mass, spring and damper",
      force_driven ? "force" : "motion",
      e.sign_reversed ? "The recorded force has the opposite sign to the motion it drives and was turned round." : "",
      study.validation ? "the second recording" : "the last 40 %, which no fit has seen", e.variants_tried,
      outcome.seconds));
  report.plots({residual_plot(study, e), spectrum_plot(study, e)});

  if (!e.effects.empty()) {
    report.section("What was added");
    io::Table table{{"effect", "acts on", "parameter", "value", "95 % interval", "error without it, " + unit},
                    {},
                    "intervals from the scatter between seconds, coloured errors included"};
    for (const auto& effect : e.effects) {
      for (std::size_t i = 0; i < effect.keys.size(); ++i) {
        const double width = effect.half_width95[i];
        table.rows.push_back(
            {i == 0 ? spoken(effect.name) : "", i == 0 ? std::string(models::place_name(effect.place)) : "",
             effect.keys[i], pretty(effect.values[i], 4),
             width > 0 ? pretty(effect.values[i] - width, 3) + " to " + pretty(effect.values[i] + width, 3) : "held",
             i == 0 ? pretty(effect.rmse_validation_without, 3) : ""});
      }
    }
    report.table(table);
    for (const auto& effect : e.effects) {
      const auto& info = models::find_effect_type(effect.name).info;
      report.paragraph(fmt::format("**{}**: {}. Source: {}.", info.title, info.equation, info.source));
    }
  }
  report.section("Base model");
  io::Table parameters{{"parameter", "before", "after", "95 % interval"}, {}, ""};
  for (const auto& p : identify::base_parameters(e.base.model)) {
    const double value = identify::get_values(e.after.model, {p})[0], width = e.base_half_width95[p.index];
    parameters.rows.push_back({p.name, pretty(identify::get_values(e.base.model, {p})[0], 4), pretty(value, 4),
                               width > 0 ? pretty(value - width, 3) + " to " + pretty(value + width, 3) : "held"});
  }
  report.table(parameters);

  report.section("Fingerprints in the base model's residual");
  report.paragraph(
      "Each effect predicts what the residual shows where it is missing. The statistic counts standard deviations "
      "between seconds; p is corrected for everything tried. "
      "Several may be seen at once, for effects resemble each other: the fits below decide.");
  io::Table prints{{"effect", "what it would show", "statistic", "p", "share of the residual", "seen"}, {}, ""};
  for (const auto& print : e.fingerprints) {
    prints.rows.push_back({spoken(print.name), print.meaning, fmt::format("{:.1f}", print.statistic),
                           print.p_value < 1e-4 ? "< 0.0001" : fmt::format("{:.4f}", print.p_value),
                           fmt::format("{:.1f} %", 100 * print.share), print.significant ? "yes" : "no"});
  }
  report.table(prints);
  report.section("Rivals");
  if (e.rivals.empty())
    report.paragraph("No other candidate came near enough to be refitted, or nothing was added.");
  else {
    io::Table rivals{{"instead", "error, " + unit, "can this recording tell?", "the experiment that would"}, {}, ""};
    for (const auto& rival : e.rivals)
      rivals.rows.push_back({spoken(rival.name), pretty(rival.rmse_validation, 3),
                             rival.indistinguishable ? "no" : "yes", rival.separate_by});
    report.table(rivals);
  }
  rest_section(report, study, e);
  margins_section(report, outcome);
  report.section("Use it");
  report.code(
      "handloop margins --scenario scenes/phantom_wall.toml --json -   # with model = \"model.toml\" for the arm's "
      "axis\nhandloop experiment --axis x --arm model.toml --out out/again");
  return report;
}

}  // namespace handloop::studies
