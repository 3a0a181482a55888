#include "studies/sweep_outputs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "control/population_margins.h"
#include "io/report.h"
#include "studies/sweep_requirements.h"

namespace handloop::studies {
namespace {

using Json = nlohmann::ordered_json;

/// As the contract has it: infinity is "inf", what does not exist is null.
Json number(double value) {
  if (std::isnan(value)) return nullptr;
  if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
  return value;
}

Json point_json(const SweepContents& c, std::size_t p) {
  const SweepCondition& condition = c.conditions[c.points[p].condition];
  const PointStatistics& cell = c.cells[p];
  const control::Share interval = control::clopper_pearson(cell.stable, cell.arms);
  Json json{{"axis", models::axis_name(condition.axis)},
            {"delay_samples", condition.delay_samples},
            {"device", condition.device},
            {"stiffness_N_per_m", c.points[p].stiffness_N_per_m},
            {"damping_Ns_per_m", c.points[p].damping_Ns_per_m},
            {"arms", cell.arms},
            {"stable", cell.stable},
            {"p_stable", cell.p_stable()},
            {"p_stable_lo95", interval.low95},
            {"p_stable_hi95", interval.high95}};
  if (c.settings.method == SweepMethod::margins)
    for (std::size_t m = 0; m < kSweepMargins.size(); ++m)
      for (std::size_t q = 0; q < kSweepQuantiles.size(); ++q)
        json[fmt::format("{}_{}", kSweepMargins[m], kSweepQuantiles[q])] = number(cell.margins[m].at(q));
  return json;
}

std::string xml(std::string_view text) {
  std::string safe;
  for (const char c : text) {
    switch (c) {
      case '<':
        safe += "&lt;";
        break;
      case '>':
        safe += "&gt;";
        break;
      case '&':
        safe += "&amp;";
        break;
      case '"':
        safe += "&quot;";
        break;
      default:
        safe += c;
    }
  }
  return safe;
}

std::string condition_name(const SweepCondition& c) {
  std::string name = fmt::format("axis {}, {} sample{} of delay", models::axis_name(c.axis), c.delay_samples,
                                 c.delay_samples == 1 ? "" : "s");
  if (c.device > 0)
    name += fmt::format(", device {} (inertia x{:.3f}, damping x{:.3f})", c.device, c.mass_factor, c.damping_factor);
  return name;
}

std::vector<double> distinct(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
  return values;
}

/// A map where the points of a condition fill a grid; otherwise coloured dots by how many are stable.
io::Plot map_of(const SweepContents& c, std::uint32_t condition, const std::string& title, const std::string& label,
                const std::function<double(const PointStatistics&)>& value, std::optional<std::array<double, 2>> range,
                std::vector<double> contours) {
  io::Plot plot;
  plot.title = title;
  plot.x_label = "stiffness K / (N/m)";
  plot.y_label = "damping B / (Ns/m)";
  plot.log_x = c.settings.stiffness.logarithmic;
  plot.log_y = c.settings.damping.logarithmic;
  plot.width_px = 560;
  plot.height_px = 380;
  std::vector<double> k, b;
  for (const SweepPoint& p : c.points) {
    if (p.condition != condition) continue;
    k.push_back(p.stiffness_N_per_m);
    b.push_back(p.damping_Ns_per_m);
  }
  const std::size_t count = k.size();
  k = distinct(k);
  b = distinct(b);
  if (c.settings.design == SweepDesign::grid && k.size() > 1 && b.size() > 1 && k.size() * b.size() == count) {
    io::HeatMap map{k, b, std::vector<double>(count, NAN), label, range, std::move(contours)};
    for (std::size_t p = 0; p < c.points.size(); ++p) {
      if (c.points[p].condition != condition) continue;
      const auto i =
          static_cast<std::size_t>(std::lower_bound(k.begin(), k.end(), c.points[p].stiffness_N_per_m) - k.begin());
      const auto j =
          static_cast<std::size_t>(std::lower_bound(b.begin(), b.end(), c.points[p].damping_Ns_per_m) - b.begin());
      const double v = value(c.cells[p]);
      map.value[j * k.size() + i] = std::isinf(v) ? Evaluation::kNone : v;
    }
    plot.heat_map = std::move(map);
    return plot;
  }
  if (k.size() > 1 && b.size() == 1) {  // one damping: a curve
    plot.y_label = label;
    plot.log_y = false;
    io::Series curve{.label = label, .style = io::Series::Style::line_points};
    for (std::size_t p = 0; p < c.points.size(); ++p) {
      if (c.points[p].condition != condition) continue;
      curve.x.push_back(c.points[p].stiffness_N_per_m);
      curve.y.push_back(value(c.cells[p]));
    }
    plot.series = {curve};
    return plot;
  }
  const std::array<std::string, 3> labels{"nearly all arms stable (>= 95 %)", "some", "few (< 50 %)"};
  const std::array<io::Colour, 3> colours{io::Colour::blue, io::Colour::amber, io::Colour::orange};
  for (std::size_t s = 0; s < 3; ++s) {
    io::Series dots{.label = labels[s], .style = io::Series::Style::points, .colour = colours[s]};
    for (std::size_t p = 0; p < c.points.size(); ++p) {
      if (c.points[p].condition != condition) continue;
      const double share = c.cells[p].p_stable();
      if ((share >= 0.95 ? 0u : share >= 0.5 ? 1u : 2u) != s) continue;
      dots.x.push_back(c.points[p].stiffness_N_per_m);
      dots.y.push_back(c.points[p].damping_Ns_per_m);
    }
    if (!dots.x.empty()) plot.series.push_back(std::move(dots));
  }
  return plot;
}

std::string method_words(const SweepSettings& s) {
  return s.method == SweepMethod::margins ? "by the poles and margins of the sampled loop"
                                          : "in the time domain by MuJoCo";
}

}  // namespace

std::string sweep_summary_json(const SweepContents& c) {
  std::uint64_t evaluations = 0, stable = 0;
  for (const PointStatistics& cell : c.cells) {
    evaluations += cell.arms;
    stable += cell.stable;
  }
  Json json{{"scenario", c.settings.scenario_name},
            {"method", sweep_method_name(c.settings.method)},
            {"design", sweep_design_name(c.settings.design)},
            {"arms", c.settings.arms},
            {"seed", c.settings.seed},
            {"percentiles", models::percentile_reading_name(c.settings.percentiles)},
            {"evaluations", evaluations},
            {"p_stable", evaluations ? static_cast<double>(stable) / static_cast<double>(evaluations) : 0.0}};
  json["requirements"] = Json::array();
  bool met = true;
  for (const RequirementOutcome& r : c.requirements) {
    json["requirements"].push_back({{"expression", r.expression}, {"met", r.met}, {"detail", r.detail}});
    met = met && r.met;
  }
  json["requirements_met"] = met;
  if (c.comparison) {
    Json comparison{{"with", c.comparison->old_name}, {"settings", c.comparison->settings}};
    comparison["points_compared"] = c.comparison->changes.size();
    comparison["regressions"] = c.comparison->regressions();
    comparison["improvements"] = c.comparison->improvements();
    comparison["changes"] = Json::array();
    for (const PointChange& change : c.comparison->changes) {
      if (change.old_stable == change.new_stable && change.lost == 0 && change.won == 0) continue;
      comparison["changes"].push_back({{"at", describe_point(change.condition, change.point)},
                                       {"old_stable", change.old_stable},
                                       {"old_arms", change.old_arms},
                                       {"new_stable", change.new_stable},
                                       {"new_arms", change.new_arms},
                                       {"paired", change.paired},
                                       {"became_unstable", change.lost},
                                       {"became_stable", change.won},
                                       {"p_value", change.p_value},
                                       {"p_value_holm", change.adjusted_p}});
    }
    json["comparison"] = comparison;
  }
  json["points"] = Json::array();
  for (std::size_t p = 0; p < c.points.size(); ++p) json["points"].push_back(point_json(c, p));
  return json.dump(1) + "\n";
}

std::string sweep_junit_xml(const SweepContents& c) {
  std::size_t failures = 0;
  std::string cases;
  for (const RequirementOutcome& r : c.requirements) {
    cases += fmt::format("  <testcase classname=\"handloop.sweep\" name=\"{}\"", xml(r.expression));
    if (r.met) {
      cases += "/>\n";
      continue;
    }
    ++failures;
    cases += fmt::format(">\n    <failure message=\"{}\"/>\n  </testcase>\n", xml(r.detail));
  }
  if (c.requirements.empty()) cases = "  <testcase classname=\"handloop.sweep\" name=\"sweep completed\"/>\n";
  return fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuite name=\"handloop sweep {}\" tests=\"{}\" failures=\"{}\" "
      "errors=\"0\">\n{}</testsuite>\n",
      xml(c.settings.scenario_name), std::max<std::size_t>(1, c.requirements.size()), failures, cases);
}

std::string sweep_report_html(const SweepContents& c) {
  const SweepSettings& s = c.settings;
  io::Report report(
      "Stability sweep: " + s.scenario_name,
      fmt::format("{} arms of the population at {} points, judged {}", s.arms, c.points.size(), method_words(s)));
  std::uint64_t evaluations = 0, stable = 0;
  std::size_t safe_points = 0;
  for (const PointStatistics& cell : c.cells) {
    evaluations += cell.arms;
    stable += cell.stable;
    safe_points += control::clopper_pearson(cell.stable, cell.arms).low95 >= 0.95;
  }
  report.section("Result");
  std::size_t failed = 0;
  for (const RequirementOutcome& r : c.requirements) failed += !r.met;
  std::vector<io::Figure> figures{
      {"arms stable, over all points",
       fmt::format("{:.1f} %",
                   evaluations ? 100.0 * static_cast<double>(stable) / static_cast<double>(evaluations) : 0.0),
       fmt::format("{} of {} evaluations", stable, evaluations)},
      {"points where at least 95 % are stable", fmt::format("{} of {}", safe_points, c.points.size()),
       "lower end of the 95 % interval"}};
  if (!c.requirements.empty())
    figures.push_back({"requirements",
                       failed ? fmt::format("{} of {} not met", failed, c.requirements.size()) : "all met", "",
                       failed ? io::Figure::Mood::bad : io::Figure::Mood::good});
  if (c.comparison)
    figures.push_back({"regressions", std::to_string(c.comparison->regressions()),
                       fmt::format("of {} points compared", c.comparison->changes.size()),
                       c.comparison->regressions() ? io::Figure::Mood::bad : io::Figure::Mood::good});
  report.figures(figures);
  if (!c.requirements.empty()) {
    io::Table table{{"requirement", "", "where it is tightest"}, {}, "Requirements hold at every point they name."};
    for (const RequirementOutcome& r : c.requirements)
      table.rows.push_back({r.expression, r.met ? "met" : "NOT met", r.detail});
    report.table(table);
  }
  report.callout(
      io::Report::Tone::assumption,
      fmt::format(
          "Arms are drawn from the statistics of Table III (percentile reading `{}`), parameters independent of each "
          "other: "
          "correlations were not published. Intervals are Clopper and Pearson's and speak of this population only.",
          models::percentile_reading_name(s.percentiles)));

  constexpr std::uint32_t kMostMaps = 24;
  for (std::uint32_t condition = 0; condition < c.conditions.size() && condition < kMostMaps; ++condition) {
    std::string heading = condition_name(c.conditions[condition]);
    heading[0] = static_cast<char>(std::toupper(heading[0]));
    report.section(heading);
    std::vector<io::Plot> maps{map_of(c, condition, "Share of arms that are stable", "share stable",
                                      [](const PointStatistics& cell) { return cell.p_stable(); }, std::array{0.0, 1.0},
                                      {0.5, 0.95})};
    if (s.method == SweepMethod::margins && s.design == SweepDesign::grid)
      maps.push_back(map_of(
          c, condition, "Disk margin that 95 % of the arms keep", "disk margin, 5 % point",
          [](const PointStatistics& cell) { return std::isnan(cell.margins[4].p05) ? 0.0 : cell.margins[4].p05; },
          std::nullopt, {}));
    report.plots(std::move(maps),
                 s.design == SweepDesign::grid
                     ? "Contours at 50 % and 95 %. Disk margin 0: more than 5 % of the arms are unstable there."
                     : "");
    io::Table table{{"K / (N/m)", "B / (Ns/m)", "stable", "share", "95 % interval", "gain p05", "phase p05 / deg",
                     "delay p05 / ms", "disk p05"},
                    {},
                    ""};
    if (s.method == SweepMethod::mujoco) table.columns.resize(5);
    std::size_t listed = 0;
    for (std::size_t p = 0; p < c.points.size(); ++p) {
      if (c.points[p].condition != condition) continue;
      if (++listed > 400) break;
      const PointStatistics& cell = c.cells[p];
      const control::Share interval = control::clopper_pearson(cell.stable, cell.arms);
      std::vector<std::string> row{io::pretty(c.points[p].stiffness_N_per_m), io::pretty(c.points[p].damping_Ns_per_m),
                                   fmt::format("{} of {}", cell.stable, cell.arms),
                                   fmt::format("{:.4f}", cell.p_stable()),
                                   fmt::format("{:.4f} to {:.4f}", interval.low95, interval.high95)};
      if (s.method == SweepMethod::margins)
        for (const double value :
             {cell.margins[0].p05, cell.margins[1].p05, 1e3 * cell.margins[2].p05, cell.margins[4].p05})
          row.push_back(io::pretty(value));
      table.rows.push_back(std::move(row));
    }
    if (listed > 400) table.caption = "The first 400 points; all are in sweep.sqlite, table cells.";
    report.html(fmt::format("<details><summary>{} points in numbers (margins: the 5 % point over the arms)</summary>",
                            std::min<std::size_t>(listed, 400)));
    report.table(table);
    report.html("</details>");
  }
  if (c.conditions.size() > kMostMaps)
    report.paragraph(fmt::format("{} more conditions are in `sweep.sqlite` (tables conditions, points, cells).",
                                 c.conditions.size() - kMostMaps));
  if (c.comparison) {
    report.section("Compared with an earlier sweep");
    report.code(c.comparison->text());
    report.paragraph(
        "Where both sweeps drew the same arms each arm is compared with itself (McNemar, exact); otherwise the shares "
        "are "
        "(Fisher, exact). Holm's correction covers all the points compared.");
  }
  return report.to_html();
}

}  // namespace handloop::studies
