#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <limits>

#include "io/output.h"
#include "io/report.h"
#include "studies/arm_bode.h"
#include "studies/arm_sampling.h"

namespace handloop::studies {
namespace {

using Quantity = std::vector<double> BodeCurve::*;

/// More lines than this make the fan no clearer.
constexpr std::size_t kFanLines = 100;

io::Series fan(const ArmBode& bode, Quantity quantity) {
  const std::size_t lines = std::min(kFanLines, bode.samples.size());
  io::Series series{
      .label = fmt::format("{} sampled arms", lines), .style = io::Series::Style::fan, .colour = io::Colour::sky};
  for (std::size_t i = 0; i < lines; ++i) {
    const auto& y = bode.samples[i].*quantity;
    series.x.insert(series.x.end(), bode.frequency_Hz.begin(), bode.frequency_Hz.end());
    series.y.insert(series.y.end(), y.begin(), y.end());
    series.x.push_back(std::numeric_limits<double>::quiet_NaN());
    series.y.push_back(std::numeric_limits<double>::quiet_NaN());
  }
  return series;
}

io::Plot empty_plot(const ArmBode& bode, std::string y_label) {
  io::Plot result{.x_label = "frequency / Hz", .y_label = std::move(y_label), .log_x = true};
  result.x_range = {{bode.frequency_Hz.front(), bode.frequency_Hz.back()}};
  result.vertical = {{0.6, ""}, {30, ""}};
  return result;
}

io::Series nominal(const ArmBode& bode, Quantity quantity) {
  const auto& c = bode.published.back();
  return {.label = c.name,
          .x = bode.frequency_Hz,
          .y = c.*quantity,
          .colour = io::Colour::ink,
          .width = 2.4,
          .dashed = true};
}

io::Plot fan_plot(const ArmBode& bode, std::string y_label, Quantity quantity, const BodeBand& band) {
  io::Plot result = empty_plot(bode, std::move(y_label));
  if (!bode.samples.empty()) {
    result.series.push_back({.label = "5 to 95 % of all",
                             .x = bode.frequency_Hz,
                             .style = io::Series::Style::band,
                             .colour = io::Colour::sky,
                             .lower = band.p05,
                             .upper = band.p95});
    result.series.push_back(fan(bode, quantity));
  }
  constexpr std::array colours{io::Colour::green, io::Colour::orange, io::Colour::purple};
  for (std::size_t i = 0; i < colours.size(); ++i) {
    const auto& c = bode.published[i];
    result.series.push_back(
        {.label = c.name, .x = bode.frequency_Hz, .y = c.*quantity, .colour = colours[i], .width = 2.2});
  }
  result.series.push_back(nominal(bode, quantity));
  return result;
}

/// The arm paper's Figure 8.
io::Plot literature_plot(const ArmBode& bode, std::string y_label, Quantity quantity) {
  io::Plot result = empty_plot(bode, std::move(y_label));
  for (const auto& c : bode.literature) {
    const bool beyond_colours = result.series.size() == 6;
    result.series.push_back({.label = c.name,
                             .x = bode.frequency_Hz,
                             .y = c.*quantity,
                             .colour = beyond_colours ? io::Colour::grey : io::Colour::automatic});
  }
  result.series.push_back(nominal(bode, quantity));
  return result;
}

void write_csv(const ArmBode& bode, const std::filesystem::path& path) {
  fmt::memory_buffer rows;
  const auto out = std::back_inserter(rows);
  fmt::format_to(out, "arm,frequency_Hz,magnitude_dB,phase_deg\n");
  for (const auto* curves : {&bode.published, &bode.literature, &bode.samples}) {
    for (const auto& c : *curves) {
      for (std::size_t i = 0; i < bode.frequency_Hz.size(); ++i) {
        fmt::format_to(out, "{},{:.6g},{:.6g},{:.6g}\n", c.name, bode.frequency_Hz[i], c.magnitude_dB[i],
                       c.phase_deg[i]);
      }
    }
  }
  io::write_file_atomically(path, std::string_view(rows.data(), rows.size()));
}

io::Table parameter_table(models::Axis axis) {
  io::Table table{.columns = {"arm", "M / kg", "k1 / N/m", "k2 / N/m", "b1 / Ns/m", "b2 / Ns/m"}};
  using models::Grip;
  for (const Grip grip : {Grip::one_N, Grip::two_N, Grip::three_N, Grip::nominal}) {
    std::vector<std::string> row{grip == Grip::nominal ? "nominal" : fmt::format("{} N grip", grip_name(grip))};
    for (const double v : to_array(published_arm(axis, grip))) row.push_back(io::pretty(v));
    table.rows.push_back(row);
  }
  table.caption = "Fu and Cavusoglu, Table I (grip force) and Table II (nominal).";
  return table;
}

}  // namespace

std::vector<io::Plot> bode_plots(const ArmBode& bode) {
  return {fan_plot(bode, "|x/F| / dB (1 m/N)", &BodeCurve::magnitude_dB, bode.magnitude_dB),
          fan_plot(bode, "phase / deg", &BodeCurve::phase_deg, bode.phase_deg)};
}

void write_arm_bode(const ArmBode& bode, const models::ArmPopulation& population,
                    const std::filesystem::path& directory) {
  io::OutputDirectory output(directory);
  const auto plots = bode_plots(bode);
  io::Report report(fmt::format("Human arm, axis {}", axis_name(population.axis())),
                    "frequency response from force at the grip to its position");
  report.section("Frequency response");
  for (const auto& p : plots) report.plot(p);
  report.paragraph(
      "The arms were identified from 0.6 to 30 Hz, between the two marks; beyond them this is the model alone.");
  if (!bode.samples.empty()) {
    report.callout(io::Report::Tone::assumption, "Sampled arms: " + population_assumptions(population) + ".");
  }
  if (!bode.literature.empty()) {
    report.section("Beside other papers");
    report.plot(literature_plot(bode, "|x/F| / dB (1 m/N)", &BodeCurve::magnitude_dB));
    report.plot(literature_plot(bode, "phase / deg", &BodeCurve::phase_deg),
                "Table V, each measured with another grip, posture and method.");
  }
  report.section("Parameters").table(parameter_table(population.axis()));
  report.write(output / "report.html");
  const auto drawings = io::draw_svg(plots);
  io::write_file_atomically(output / "magnitude.svg", drawings[0]);
  io::write_file_atomically(output / "phase.svg", drawings[1]);
  write_csv(bode, output / "bode.csv");
  output.commit();
}

}  // namespace handloop::studies
