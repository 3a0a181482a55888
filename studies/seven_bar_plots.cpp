#include "studies/seven_bar_plots.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "control/controllers/force_amplifier.h"
#include "io/output.h"
#include "io/report.h"
#include "models/seven_bar_arm.h"
#include "studies/seven_bar_report.h"
#include "studies/seven_bar_simulation.h"

namespace handloop::studies {
namespace {

using Complex = std::complex<double>;
using io::Colour;

std::vector<double> frequencies(double low, double high, std::size_t count = 300) {
  std::vector<double> w(count);
  for (std::size_t i = 0; i < count; ++i) {
    w[i] = low * std::pow(high / low, static_cast<double>(i) / static_cast<double>(count - 1));
  }
  return w;
}

template <typename F>
io::Series curve(const std::string& label, const std::vector<double>& w, F magnitude, Colour colour) {
  io::Series series{.label = label, .x = w, .colour = colour};
  for (const double at : w) series.y.push_back(magnitude(at));
  return series;
}

io::Plot log_plot(const std::string& title, const std::string& y_label) {
  io::Plot plot;
  plot.title = title;
  plot.x_label = "frequency (rad/s)";
  plot.y_label = y_label;
  plot.log_x = plot.log_y = true;
  return plot;
}

io::Plot hand_plot() {
  auto plot = log_plot("Human arm at the handle (Figure 8)", "|H| (N/m)");
  const auto w = frequencies(0.1, 100);
  const models::HandImpedance printed;
  plot.series.push_back(curve(
      "H_0 as printed (18)", w,
      [&](double at) {
        return std::abs(printed({0, at}));
      },
      Colour::ink));
  for (const auto& [hand, label, colour] :
       {std::tuple{models::SevenBarHand::tight, "tight grip, appendix", Colour::blue},
        {models::SevenBarHand::loose, "loose grip, appendix", Colour::orange}}) {
    const auto arm = models::neural_arm(hand);
    auto series = curve(
        label, w,
        [&](double at) {
          return std::abs(arm.impedance({0, at}));
        },
        colour);
    series.dashed = true;
    plot.series.push_back(series);
  }
  return plot;
}

io::Plot primary_plot(const control::ForceControl& loop, const control::Sensitivity& s,
                      const std::vector<PrimaryPoint>& measured) {
  auto plot = log_plot("Position loop along y: what it follows and what it leaves of forces", "m/N, or 1 for G");
  const auto w = frequencies(0.3, 300);
  plot.series.push_back(curve(
      "|G| (17)", w,
      [&](double at) {
        return std::abs(loop.primary({0, at}));
      },
      Colour::ink));
  plot.series.push_back(curve(
      "|G K alpha|", w,
      [&](double at) {
        const Complex s_(0, at);
        return std::abs(loop.primary(s_) * loop.K(s_) * loop.alpha(s_)(1, 1));
      },
      Colour::green));
  plot.series.push_back(curve(
      "|G K|", w,
      [&](double at) {
        return std::abs(loop.primary({0, at}) * loop.K({0, at}));
      },
      Colour::purple));
  plot.series.push_back(curve(
      "|S_e|", w, [&](double at) { return std::abs(s.to_environment(at)(1, 1)); }, Colour::orange));
  plot.series.push_back(curve(
      "|S_h|", w, [&](double at) { return std::abs(s.to_hand(at)(1, 1)); }, Colour::blue));
  for (const auto& [label, value, colour] : {std::tuple{"measured", &PrimaryPoint::G, Colour::ink},
                                             {"", &PrimaryPoint::S_e_m_per_N, Colour::orange},
                                             {"", &PrimaryPoint::S_h_m_per_N, Colour::blue}}) {
    io::Series points{.label = label, .style = io::Series::Style::points, .colour = colour};
    for (const auto& point : measured) {
      if (point.axis != 1) continue;
      points.x.push_back(point.frequency_rad_per_s);
      points.y.push_back(std::abs(point.*value));
    }
    if (!points.x.empty()) plot.series.push_back(points);
  }
  return plot;
}

io::Plot performance_plot(const SevenBarMargins& margins) {
  auto plot = log_plot("Performance: how far (f_h - f_h*)/f_e is from -R, inequality (8)", "largest singular value");
  io::Series error{.label = "left side of (8)", .colour = Colour::blue};
  for (const auto& point : margins.performance.points) {
    error.x.push_back(point.frequency_rad_per_s);
    error.y.push_back(point.error);
  }
  plot.series.push_back(error);
  plot.horizontal.push_back({.at = margins.epsilon, .label = "epsilon"});
  return plot;
}

io::Plot nyquist_plot(const control::ForceControl& loop) {
  io::Plot plot;
  plot.title = "Loop G K (alpha H_0 + E) along y";
  plot.x_label = "real part";
  plot.y_label = "imaginary part";
  plot.x_range = {{-2.0, 1.0}};
  plot.y_range = {{-1.5, 1.5}};
  plot.equal_axes = true;
  plot.width_px = 620;
  plot.height_px = 560;
  auto changed = loop;
  for (const auto& [alpha, colour] :
       {std::pair{5.0, Colour::green}, {8.0, Colour::blue}, {12.39, Colour::amber}, {19.0, Colour::orange}}) {
    changed.alpha.entries[1][1] = {{alpha}, {1}};
    const auto transfer = control::axis_loop(changed, 1);
    io::Series series{.label = fmt::format("alpha = {:g}", alpha), .colour = colour};
    for (const double w : frequencies(0.5, 2000, 1500)) {
      const Complex value = transfer(w);
      const bool inside = std::abs(value) < 4;
      series.x.push_back(inside ? value.real() : std::nan(""));
      series.y.push_back(inside ? value.imag() : std::nan(""));
    }
    plot.series.push_back(series);
  }
  plot.annotations.push_back({-1.0, 0.0, "-1"});
  return plot;
}

io::Plot growth_plot(const SevenBarEvidence& evidence) {
  io::Plot plot;
  plot.title = "Simulated: does an oscillation along y grow?";
  plot.x_label = "alpha in y";
  plot.y_label = "growth rate (1/s)";
  io::Series points{.label = "simulated", .style = io::Series::Style::line_points, .colour = Colour::blue};
  for (const auto& [alpha, rate] : evidence.growth) {
    points.x.push_back(alpha);
    points.y.push_back(rate);
  }
  plot.series.push_back(points);
  plot.horizontal.push_back({.at = 0.0});
  if (const auto& limit = evidence.margins.axes[1].modelled) {
    plot.vertical.push_back({.at = limit->factor, .label = fmt::format("predicted {:.2f}", limit->factor)});
  }
  plot.vertical.push_back({.at = evidence.margins.alpha_limit,
                           .label = fmt::format("S = 0, as printed: {:.2f}", evidence.margins.alpha_limit),
                           .colour = Colour::orange});
  return plot;
}

}  // namespace

SevenBarEvidence seven_bar_evidence(const models::Scenario& scenario) {
  SevenBarEvidence evidence;
  evidence.margins = seven_bar_margins(scenario);
  evidence.primary = measure_primary(
      scenario, {.frequencies_rad_per_s = {0.8, 1.6, 3.1, 6.3, 12.5, 25, 50, 100, 200}, .period_s = 8.0});
  const double near = evidence.margins.axes[1].modelled ? evidence.margins.axes[1].modelled->factor : 12.0;
  evidence.simulated_limit_y = simulated_alpha_limit(scenario, 1, near);
  auto changed = scenario;
  for (const double alpha : {10.0, 10.5, 11.0, 11.5, 12.0}) {
    changed.force_amplifier.alpha_yy = {0, 0, 0, alpha};
    evidence.growth.emplace_back(alpha, simulated_growth_per_s(changed, 1));
  }
  return evidence;
}

std::vector<std::pair<std::string, io::Plot>> seven_bar_plots(const models::Scenario& scenario,
                                                              const SevenBarEvidence& evidence) {
  const Eigen::Vector2d th(scenario.device.pose_rad[0], scenario.device.pose_rad[1]);
  const auto loop = control::force_control_of(scenario, th);
  const control::ModelledPrimary primary(scenario, th);
  return {{"hand", hand_plot()},
          {"primary", primary_plot(loop, primary, evidence.primary)},
          {"performance", performance_plot(evidence.margins)},
          {"nyquist", nyquist_plot(loop)},
          {"growth", growth_plot(evidence)}};
}

void write_seven_bar_margins(const models::Scenario& scenario, const std::filesystem::path& target) {
  const auto evidence = seven_bar_evidence(scenario);
  io::OutputDirectory directory(target);
  auto json = to_json(evidence.margins);
  json["simulated_limit_y"] = evidence.simulated_limit_y;
  for (const auto& point : evidence.primary) {
    json["primary"].push_back({{"axis", point.axis == 0 ? "x" : "y"},
                               {"frequency_rad_per_s", point.frequency_rad_per_s},
                               {"G_abs", std::abs(point.G)},
                               {"G_deg", std::arg(point.G) * 180 / std::numbers::pi},
                               {"S_h_m_per_N", std::abs(point.S_h_m_per_N)},
                               {"S_e_m_per_N", std::abs(point.S_e_m_per_N)}});
  }
  io::write_file_atomically(directory / "margins.json", json.dump(2) + "\n");
  io::Report report(fmt::format("Margins of {}", scenario.name), scenario.description);
  report.section("Outcome");
  report.callout(io::Report::Tone::assumption, kSevenBarAssumption);
  report.code(to_text(evidence.margins));
  report.paragraph(
      fmt::format("Simulated, with converters, delays and the whole mechanism, alpha in y is at its limit "
                  "at **{:.2f}**.",
                  evidence.simulated_limit_y));
  report.section("Pictures");
  for (const auto& [name, plot] : seven_bar_plots(scenario, evidence)) report.plot(plot);
  report.section("Position loop, measured");
  io::Table table{.columns = {"axis", "rad/s", "G off (17), dB", "deg", "|S_h| m/N", "|S_e| m/N", "|G K| m/N"},
                  .rows = {}};
  const models::PrimaryLoop G;
  const auto K = control::filter_of(scenario.force_amplifier);
  for (const auto& p : evidence.primary) {
    const Complex s(0, p.frequency_rad_per_s), ratio = p.G / G(s);
    table.rows.push_back({p.axis == 0 ? "x" : "y", io::pretty(p.frequency_rad_per_s),
                          fmt::format("{:.3f}", 20 * std::log10(std::abs(ratio))),
                          fmt::format("{:.2f}", std::arg(ratio) * 180 / std::numbers::pi),
                          io::pretty(std::abs(p.S_h_m_per_N), 3), io::pretty(std::abs(p.S_e_m_per_N), 3),
                          io::pretty(std::abs(G(s) * K(s)), 3)});
  }
  report.table(table);
  report.write(directory / "report.html");
  directory.commit();
}

void write_seven_bar_figures(const models::Scenario& scenario, const std::filesystem::path& target) {
  auto plots = seven_bar_plots(scenario, seven_bar_evidence(scenario));
  SevenBarRunTrace trace = trace_of(scenario);
  for (auto& plot : seven_bar_figures(scenario, trace, true).plots) plots.push_back(std::move(plot));
  auto unstable = scenario;
  unstable.force_amplifier.alpha_yy = {0, 0, 0, 19};
  unstable.run.duration_s = 2.0;
  trace = trace_of(unstable);
  for (auto& [name, plot] : seven_bar_figures(unstable, trace, false).plots) {
    plots.emplace_back("unstable_" + name, std::move(plot));
  }
  std::vector<io::Plot> drawn;
  for (const auto& [name, plot] : plots) drawn.push_back(plot);
  const auto svg = io::draw_svg(drawn);
  io::OutputDirectory directory(target);
  for (std::size_t i = 0; i < svg.size(); ++i) io::write_file_atomically(directory / (plots[i].first + ".svg"), svg[i]);
  directory.commit();
}

}  // namespace handloop::studies
