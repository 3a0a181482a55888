#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "io/report.h"
#include "models/arm_tables.h"
#include "studies/identification.h"

namespace handloop::studies {

namespace {

using io::Colour;
using io::Plot;
using io::Report;
using io::Series;

constexpr double kTwoPi = 2 * std::numbers::pi;
constexpr std::array kGripColours{Colour::green, Colour::orange, Colour::purple};
constexpr std::array<std::string_view, 5> kShort{"M / kg", "k1 / N/m", "k2 / N/m", "b1 / Ns/m", "b2 / Ns/m"};

std::string axis_title(const AxisSet& set) {
  if (!set.axis) return "axis not given";
  constexpr std::array<std::string_view, 3> kMotion{"left-right", "up-down", "forward-backward"};
  return fmt::format("{} axis ({})", std::array{"X", "Y", "Z"}[static_cast<std::size_t>(*set.axis)],
                     kMotion[static_cast<std::size_t>(*set.axis)]);
}

double decibel(std::complex<double> h) {
  return 20 * std::log10(std::abs(h));
}

/// Phase in degrees between -270 and 90: an arm's lies between -180 and 0, and noise must not jump.
double phase_deg(std::complex<double> h) {
  const double p = std::arg(h) * 180 / std::numbers::pi;
  return p > 90 ? p - 360 : p;
}

std::vector<double> mapped(const std::vector<std::complex<double>>& h, double (*quantity)(std::complex<double>)) {
  std::vector<double> out;
  for (const auto& v : h) out.push_back(quantity(v));
  return out;
}

std::vector<double> fine_frequencies() {
  std::vector<double> f;
  for (int i = 0; i <= 200; ++i) f.push_back(0.5 * std::pow(60.0, i / 200.0));
  return f;
}

std::vector<double> model_curve(const models::ArmParameters& arm, const std::vector<double>& f,
                                double (*quantity)(std::complex<double>)) {
  std::vector<double> out;
  for (const double x : f) out.push_back(quantity(models::compliance(arm, {0, kTwoPi * x})));
  return out;
}

Plot bode_frame(std::string title, std::string y_label) {
  Plot plot{.title = std::move(title), .x_label = "frequency / Hz", .y_label = std::move(y_label), .log_x = true};
  plot.x_range = {{0.5, 30}};
  plot.width_px = 440;
  plot.height_px = 330;
  return plot;
}

// ---- figures of the paper ----------------------------------------------------------------------------------------

void figure_3(Report& report, const Identification& result) {
  report.section("Signals (Figure 3)");
  Plot force{.x_label = "time / s", .y_label = "force / N"};
  force.height_px = 240;
  force.series = {{.x = result.example_time_s, .y = result.example_force_N, .colour = Colour::blue, .width = 1.2}};
  Plot position{.x_label = "time / s", .y_label = "position / mm"};
  position.height_px = 240;
  Series line{.x = result.example_time_s, .colour = Colour::orange, .width = 1.2};
  for (const double x : result.example_position_m) line.y.push_back(1e3 * x);
  position.series = {line};
  report.plot(force);
  report.plot(position, fmt::format("The first 5 s of {}.", result.example_name));
}

void figure_5(Report& report, const Identification& result) {
  report.section("Coherence (Figure 5)");
  std::vector<Plot> plots;
  for (const auto& set : result.sets) {
    Plot plot = bode_frame(axis_title(set), "coherence");
    plot.y_range = {{0, 1.02}};
    std::size_t colour = 0;
    for (const auto& [grip, response] : set.grip_response) {
      plot.series.push_back({.label = fmt::format("{} N grip", grip),
                             .x = response.frequency_Hz,
                             .y = response.coherence,
                             .colour = kGripColours[colour++ % kGripColours.size()]});
    }
    if (set.grip_response.empty()) {
      for (const auto i : set.trials) {
        const auto& r = result.trials[i].by(result.method).response;
        plot.series.push_back({.label = set.trials.size() == 1 ? result.trials[i].name : "",
                               .x = r.frequency_Hz,
                               .y = r.coherence,
                               .colour = Colour::blue,
                               .width = 1.2});
      }
    }
    plots.push_back(plot);
  }
  report.plots(plots, result.sets.front().grip_response.empty()
                          ? "Magnitude-squared coherence of force and position."
                          : "Magnitude-squared coherence of force and position, the mean over subjects.");
}

void figure_6(Report& report, const Identification& result) {
  if (result.sets.front().by_grip.empty()) return;
  report.section("Models by grip force (Figure 6, Set 1)");
  for (const auto& set : result.sets) {
    Plot magnitude = bode_frame(axis_title(set), "|x/F| / dB (1 m/N)"), phase = bode_frame("", "phase / deg");
    const auto f = fine_frequencies();
    std::size_t colour = 0;
    for (const auto& [grip, fit] : set.by_grip) {
      const auto& measured = set.grip_response.at(grip);
      const Colour c = kGripColours[colour++ % kGripColours.size()];
      const std::string label = fmt::format("{} N grip", grip);
      magnitude.series.push_back(
          {.label = label, .x = f, .y = model_curve(fit.arm, f, decibel), .colour = c, .width = 2.4});
      magnitude.series.push_back(
          {.x = measured.frequency_Hz, .y = mapped(measured.response, decibel), .colour = c, .width = 0.8});
      phase.series.push_back(
          {.label = label, .x = f, .y = model_curve(fit.arm, f, phase_deg), .colour = c, .width = 2.4});
      phase.series.push_back(
          {.x = measured.frequency_Hz, .y = mapped(measured.response, phase_deg), .colour = c, .width = 0.8});
    }
    report.plots({magnitude, phase});
  }
  report.paragraph(
      "Thick: eq. (1) fitted to the mean response over subjects, weighted by the mean coherence. Thin: that response.");
  io::Table table{.columns = {"axis", "grip", "M / kg", "k1 / N/m", "k2 / N/m", "b1 / Ns/m", "b2 / Ns/m"}};
  for (const auto& set : result.sets) {
    for (const auto& [grip, fit] : set.by_grip) {
      std::vector<std::string> row{set.axis ? std::string(models::axis_name(*set.axis)) : "",
                                   fmt::format("{} N", grip)};
      for (const double v : models::to_array(fit.arm)) row.push_back(io::pretty(v));
      table.rows.push_back(row);
    }
  }
  table.caption = "As Table I.";
  report.table(table);
}

Series fan_of(const std::vector<const identify::FrequencyResponse*>& responses,
              double (*quantity)(std::complex<double>)) {
  Series fan{.label = "each recording", .style = Series::Style::fan, .colour = Colour::sky};
  for (const auto* r : responses) {
    const auto y = mapped(r->response, quantity);
    fan.x.insert(fan.x.end(), r->frequency_Hz.begin(), r->frequency_Hz.end());
    fan.y.insert(fan.y.end(), y.begin(), y.end());
    fan.x.push_back(std::numeric_limits<double>::quiet_NaN());
    fan.y.push_back(std::numeric_limits<double>::quiet_NaN());
  }
  return fan;
}

Plot envelope_plot(const AxisSet& set) {
  Plot plot = bode_frame(axis_title(set), "|W_u| / dB");
  const auto f = fine_frequencies();
  const auto curve = [&](const models::UncertaintyModel& v) {
    std::vector<double> y;
    for (const double x : f) y.push_back(decibel(v({0, kTwoPi * x})));
    return y;
  };
  const auto& data = *set.variability;
  plot.series.push_back({.label = "max, data",
                         .x = data.frequency_Hz,
                         .y = data.maximum_dB,
                         .style = Series::Style::points,
                         .colour = Colour::purple});
  plot.series.push_back(
      {.label = "max, V(s)", .x = f, .y = curve(set.maximum->fitted.model), .colour = Colour::purple, .dashed = true});
  plot.series.push_back({.label = "67 %, data",
                         .x = data.frequency_Hz,
                         .y = data.percentile67_dB,
                         .style = Series::Style::points,
                         .colour = Colour::green});
  plot.series.push_back(
      {.label = "67 %, V(s)", .x = f, .y = curve(set.percentile67->fitted.model), .colour = Colour::green});
  return plot;
}

void figure_7(Report& report, const Identification& result) {
  report.section("Nominal arms and variability (Figure 7, Set 2)");
  const auto f = fine_frequencies();
  io::Table envelopes{.columns = {"axis", "set", "order", "gain", "mean excess / dB", "largest / dB",
                                  "Table IV, lifted / dB", "Table IV, lowest / dB"}};
  io::Table nominal{.columns = {"axis", "M / kg", "k1 / N/m", "k2 / N/m", "b1 / Ns/m", "b2 / Ns/m"}};
  std::vector<Plot> spread;
  for (const auto& set : result.sets) {
    std::vector<const identify::FrequencyResponse*> responses;
    for (const auto i : set.trials) responses.push_back(&result.trials[i].by(result.method).response);
    Plot magnitude = bode_frame(axis_title(set), "|x/F| / dB (1 m/N)"), phase = bode_frame("", "phase / deg");
    magnitude.series.push_back(fan_of(responses, decibel));
    phase.series.push_back(fan_of(responses, phase_deg));
    const models::ArmParameters arm =
        set.nominal ? set.nominal->arm : result.trials[set.trials[0]].by(result.method).fit.arm;
    const std::string label = set.nominal ? "nominal arm" : "fitted arm";
    magnitude.series.push_back({.label = label,
                                .x = f,
                                .y = model_curve(arm, f, decibel),
                                .colour = Colour::ink,
                                .width = 2.4,
                                .dashed = true});
    phase.series.push_back({.label = label,
                            .x = f,
                            .y = model_curve(arm, f, phase_deg),
                            .colour = Colour::ink,
                            .width = 2.4,
                            .dashed = true});
    std::vector<Plot> plots{magnitude, phase};
    if (set.maximum) spread.push_back(envelope_plot(set));
    report.plots(plots);
    const std::string axis = set.axis ? std::string(models::axis_name(*set.axis)) : "";
    if (set.nominal) {
      std::vector<std::string> row{axis};
      for (const double v : models::to_array(set.nominal->arm)) row.push_back(io::pretty(v));
      nominal.rows.push_back(row);
    }
    for (const auto& [name, envelope] : {std::pair{"max", &set.maximum}, std::pair{"67", &set.percentile67}}) {
      if (!*envelope) continue;
      const auto& e = **envelope;
      envelopes.rows.push_back({axis, name, fmt::format("{}", 2 * e.fitted.model.poles.size()),
                                io::pretty(e.fitted.model.gain), fmt::format("{:.3f}", e.fitted.mean_excess_dB),
                                fmt::format("{:.3f}", e.fitted.largest_excess_dB),
                                e.published_lifted ? fmt::format("{:.2f}", e.published_lifted->mean_excess_dB) : "",
                                e.published ? fmt::format("{:.2f}", e.published->least_excess_dB) : ""});
    }
  }
  if (!spread.empty()) report.plots(spread, "Distance from the nominal arm, and the envelopes V(s) fitted to it.");
  if (!nominal.rows.empty()) {
    nominal.caption = "As Table II: eq. (1) fitted to the centres of the minimum bounding circles, without weights.";
    report.table(nominal);
  }
  if (!envelopes.rows.empty()) {
    envelopes.caption =
        "Stable, minimum-phase envelopes of |W_u|: never below the data. Beside them the published Table IV on the "
        "same data: "
        "mean excess with its gain changed until it touches them from above (lifted), and its lowest point over them "
        "as "
        "published (below 0 it is no envelope of this data).";
    report.table(envelopes);
  }
}

void figure_8(Report& report, const Identification& result) {
  for (const auto& set : result.sets) {
    if (set.axis != models::Axis::z) continue;
    report.section("Beside other papers (Figure 8)");
    const models::ArmParameters arm =
        set.nominal ? set.nominal->arm : result.trials[set.trials[0]].by(result.method).fit.arm;
    const auto f = fine_frequencies();
    std::vector<Plot> plots;
    for (const bool magnitude : {true, false}) {
      Plot plot = bode_frame("", magnitude ? "|x/F| / dB (1 m/N)" : "phase / deg");
      const auto quantity = magnitude ? decibel : phase_deg;
      for (const auto& other : models::literature_arms()) {
        if (other.axis && *other.axis != models::Axis::z) continue;
        const auto model = other.model();
        std::vector<double> y;
        for (const double x : f) y.push_back(quantity(models::compliance(model, {}, {0, kTwoPi * x})));
        plot.series.push_back({.label = std::string(other.name), .x = f, .y = y});
      }
      plot.series.push_back({.label = "this data, Z",
                             .x = f,
                             .y = model_curve(arm, f, quantity),
                             .colour = Colour::ink,
                             .width = 2.4,
                             .dashed = true});
      plots.push_back(plot);
    }
    report.plots(plots,
                 "Models of Table V that move forward and backward (or give no axis), each measured with another grip, "
                 "posture and method.");
  }
}

// ---- tables ------------------------------------------------------------------------------------------------------

io::Table statistics_table(const AxisSet& set) {
  io::Table table{.columns = {""}};
  for (const auto name : kShort) {
    table.columns.emplace_back(name);
    if (set.truth) table.columns.emplace_back("true");
  }
  using S = models::ParameterStatistics;
  constexpr std::array<std::pair<const char*, double S::*>, 8> kRows{{{"minimum", &S::minimum},
                                                                      {"mean", &S::mean},
                                                                      {"maximum", &S::maximum},
                                                                      {"std dev", &S::standard_deviation},
                                                                      {"95 % CI min", &S::ci95_minimum},
                                                                      {"95 % CI max", &S::ci95_maximum},
                                                                      {"67 % CI min", &S::ci67_minimum},
                                                                      {"67 % CI max", &S::ci67_maximum}}};
  for (const auto& [name, member] : kRows) {
    std::vector<std::string> row{name};
    for (std::size_t p = 0; p < 5; ++p) {
      row.push_back(io::pretty(set.statistics[p].*member));
      if (set.truth) row.push_back(io::pretty((*set.truth)[p].*member));
    }
    table.rows.push_back(row);
  }
  table.caption = axis_title(set);
  return table;
}

void structured(Report& report, const Identification& result) {
  report.section("Statistics of the parameters (Table III, Set 3)");
  for (const auto& set : result.sets) report.table(statistics_table(set));
  report.paragraph(
      fmt::format("The ends marked CI are percentiles of the empirical distribution, `--percentiles {}`{}. Method: {}.",
                  models::percentile_reading_name(result.percentiles),
                  result.percentiles == models::PercentileReading::ecdf
                      ? ": 5, 95, 33 and 67 %, the reading under which the paper's own Table III is consistent (an "
                        "inference, the paper does not say)"
                      : ": the central 95 and 67 %",
                  method_name(result.method)));
}

void both_methods(Report& report, const Identification& result) {
  report.section("Both methods side by side");
  const bool truth = result.sets.front().truth.has_value();
  io::Table table{.columns = {"axis", "parameter", "paper", "unbiased", "paper / unbiased - 1"}};
  if (truth) table.columns.insert(table.columns.end(), {"true", "bias of paper", "bias of unbiased"});
  const bool paper_first = result.method == IdentificationMethod::paper;
  for (std::size_t s = 0; s < result.sets.size(); ++s) {
    const auto& paper = paper_first ? result.sets[s] : result.other_sets[s];
    const auto& unbiased = paper_first ? result.other_sets[s] : result.sets[s];
    for (std::size_t p = 0; p < 5; ++p) {
      const double a = paper.statistics[p].mean, b = unbiased.statistics[p].mean;
      std::vector<std::string> row{paper.axis ? std::string(models::axis_name(*paper.axis)) : "",
                                   std::string(kShort[p]), io::pretty(a), io::pretty(b),
                                   fmt::format("{:+.2f} %", 100 * (a / b - 1))};
      if (truth && paper.truth) {
        row.push_back(io::pretty((*paper.truth)[p].mean));
        row.push_back(fmt::format("{:+.2f} %", 100 * paper.bias[p]));
        row.push_back(fmt::format("{:+.2f} %", 100 * unbiased.bias[p]));
      }
      row.resize(table.columns.size());
      table.rows.push_back(row);
    }
  }
  table.caption = "Means over the recordings of an axis.";
  report.table(table);
  report.callout(
      Report::Tone::note,
      fmt::format("{}, and takes the force for continuous: where it was held between samples, half a sample of delay "
                  "goes into b1. The unbiased method transforms the whole record, and the hold is part of its model.",
                  result.spectra == SpectralEstimate::welch
                      ? "The paper's method averages segments of 1.9 s, whose leakage lowers M and raises b2"
                      : "The paper's fit has its frequency response from local polynomials here (`--spectra local`), "
                        "without the leakage of the paper's segments of 1.9 s"));
  std::map<std::string, int> holds;
  int unclear = 0, delayed = 0;
  for (const auto& t : result.trials) {
    ++holds[std::string(identify::hold_name(t.by(IdentificationMethod::unbiased).fit.hold))];
    unclear += t.hold_is_clear ? 0 : 1;
    delayed += t.by(IdentificationMethod::unbiased).fit.delay_s != 0 ? 1 : 0;
  }
  std::string text = "Force between samples, as the recordings say:";
  for (const auto& [name, count] : holds) text += fmt::format(" {} in {};", name, count);
  text.back() = '.';
  if (unclear > 0) text += fmt::format(" In {} the next best explains the data nearly as well.", unclear);
  if (delayed > 0) text += fmt::format(" In {} a delay was fitted along.", delayed);
  report.paragraph(text);
  for (const auto& set : result.sets) {
    if (!set.truth) continue;
    std::vector<Plot> plots;
    for (std::size_t p = 0; p < 5; ++p) {
      Plot plot{.title = std::string(kShort[p]), .x_label = "true", .y_label = "error / % of the mean"};
      plot.width_px = 440;
      plot.height_px = 280;
      for (const auto method : {IdentificationMethod::paper, IdentificationMethod::unbiased}) {
        Series points{.label = std::string(method_name(method)),
                      .style = Series::Style::points,
                      .colour = method == IdentificationMethod::paper ? Colour::orange : Colour::blue};
        for (const auto i : set.trials) {
          const double x = models::to_array(*result.trials[i].trial.truth)[p];
          points.x.push_back(x);
          points.y.push_back(100 * (models::to_array(result.trials[i].by(method).fit.arm)[p] - x) /
                             (*set.truth)[p].mean);
        }
        plot.series.push_back(points);
      }
      plot.horizontal = {{0, ""}};
      plots.push_back(plot);
    }
    report.plots(plots, axis_title(set) + ": error of each recording.");
  }
}

void grip_effect(Report& report, const Identification& result) {
  io::Table table{
      .columns = {"axis", "parameter", "F", "epsilon", "p (Greenhouse-Geisser)", "smallest p of pairs (Holm-Sidak)"}};
  for (const auto& set : result.sets) {
    if (!set.grip_effect) continue;
    for (std::size_t p = 0; p < 5; ++p) {
      const auto& r = (*set.grip_effect)[p];
      double least = 1;
      for (const auto& pair : r.pairs) least = std::min(least, pair.p_holm_sidak);
      table.rows.push_back({set.axis ? std::string(models::axis_name(*set.axis)) : "", std::string(kShort[p]),
                            fmt::format("F({:.3g}, {:.3g}) = {:.3f}", r.epsilon * r.numerator_freedom,
                                        r.epsilon * r.denominator_freedom, r.F),
                            fmt::format("{:.3f}", r.epsilon), fmt::format("{:.4f}", r.p_greenhouse_geisser),
                            fmt::format("{:.4f}", least)});
    }
  }
  if (table.rows.empty()) return;
  report.section("Does grip force matter?");
  table.caption =
      "One-way repeated-measures analysis of variance, grip force as the factor, subjects complete at every grip.";
  report.table(table);
}

void time_domain(Report& report, const Identification& result) {
  report.section("Errors in time");
  io::Table table{.columns = {"axis", "recordings", "mean / mm", "std / mm", "maximum / mm", "minimum / mm"}};
  std::vector<double> all;
  const auto add = [&](const std::string& axis, std::size_t count, const models::ParameterStatistics& s) {
    std::vector<std::string> row{axis, fmt::format("{}", count)};
    for (const double v : {s.mean, s.standard_deviation, s.maximum, s.minimum})
      row.push_back(fmt::format("{:.3f}", 1e3 * v));
    table.rows.push_back(row);
  };
  for (const auto& set : result.sets) {
    add(set.axis ? std::string(models::axis_name(*set.axis)) : "", set.trials.size(), set.rmse_m);
    for (const auto i : set.trials) all.push_back(result.trials[i].by(result.method).rmse_m);
  }
  if (result.sets.size() > 1) add("all", all.size(), identify::describe(all, result.percentiles));
  table.caption =
      "Root-mean-square difference of the measured position and the one simulated from the measured force with the "
      "fitted arm, "
      "means removed. (The paper reports 2.39 mm on average, std 2.73, 0.72 to 7.25 mm, with people.)";
  report.table(table);
}

void warnings(Report& report, const Identification& result) {
  std::vector<std::string> lines;
  for (const auto& s : result.skipped) lines.push_back("Left out: " + s);
  for (const auto& t : result.trials) {
    for (const auto& w : t.doubts) lines.push_back(fmt::format("{}: {}", t.name, w));
    for (const auto& w : t.by(result.method).fit.warnings) lines.push_back(fmt::format("{}: {}", t.name, w));
  }
  report.section("What the recordings do not determine");
  if (lines.empty()) {
    report.paragraph(
        "Every parameter of every recording is determined: no 95 % interval is wider than its value, none ended at a "
        "bound.");
    return;
  }
  report.paragraph(fmt::format("{} remarks.", lines.size()));
  report.list(lines);
}

void fits_table(Report& report, const Identification& result) {
  constexpr std::size_t kMostRows = 40;
  report.section("Fits");
  io::Table table{.columns = {"trial", "axis", "subject", "grip"}};
  for (const auto name : kShort) table.columns.emplace_back(name);
  table.columns.insert(table.columns.end(), {"nrmse", "misfit"});
  for (const auto& t : result.trials) {
    if (table.rows.size() == kMostRows) break;
    const auto& r = t.by(result.method);
    std::vector<std::string> row{fmt::format("{}", t.trial.trial),
                                 t.trial.axis ? std::string(models::axis_name(*t.trial.axis)) : "",
                                 t.trial.subject > 0 ? fmt::format("{}", t.trial.subject) : "",
                                 t.trial.grip > 0 ? fmt::format("{} N", t.trial.grip) : ""};
    const auto values = models::to_array(r.fit.arm);
    for (std::size_t p = 0; p < 5; ++p) {
      row.push_back(fmt::format("{} ± {}", io::pretty(values[p]), io::pretty(1.96 * r.fit.standard_error[p], 2)));
    }
    row.push_back(fmt::format("{:.4f}", r.nrmse));
    row.push_back(fmt::format("{:.2f}", t.misfit));
    table.rows.push_back(row);
  }
  table.caption = result.trials.size() > kMostRows
                      ? fmt::format("The first {} of {}; all are in fits.csv.", kMostRows, result.trials.size())
                      : std::string("As in fits.csv.");
  table.caption +=
      " Misfit: chi squared a degree of freedom of the unbiased method; far above 1, eq. (1) is not the whole story.";
  report.table(table);
}

}  // namespace

std::string identification_report(const Identification& result) {
  Report report("Identified arms",
                fmt::format("{} recordings, method {}", result.trials.size(), method_name(result.method)));
  double nrmse = 0;
  for (const auto& t : result.trials) nrmse += t.by(result.method).nrmse / static_cast<double>(result.trials.size());
  std::vector<io::Figure> cards{
      {"recordings", fmt::format("{}", result.trials.size()),
       result.skipped.empty() ? "" : fmt::format("{} left out", result.skipped.size())},
      {"position unexplained", fmt::format("{:.1f} %", 100 * nrmse), "mean nrmse, whole records"}};
  double worst = 0;
  std::string worst_name;
  for (const auto& set : result.sets) {
    for (std::size_t p = 0; set.truth && p < 5; ++p) {
      if (std::abs(set.bias[p]) <= std::abs(worst)) continue;
      worst = set.bias[p];
      worst_name = fmt::format("{} in {}", models::kArmParameterNames[p], set.axis ? models::axis_name(*set.axis) : "");
    }
  }
  if (!worst_name.empty()) cards.push_back({"largest mean bias", fmt::format("{:+.2f} %", 100 * worst), worst_name});
  report.section("Summary").figures(cards);
  figure_3(report, result);
  figure_5(report, result);
  figure_6(report, result);
  figure_7(report, result);
  figure_8(report, result);
  structured(report, result);
  both_methods(report, result);
  grip_effect(report, result);
  time_domain(report, result);
  fits_table(report, result);
  warnings(report, result);
  return report.to_html();
}

}  // namespace handloop::studies
