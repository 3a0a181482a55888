#include "studies/seven_bar_report.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "control/controllers/force_amplifier.h"
#include "control/controllers/seven_bar_mechanism.h"
#include "device/live_loop.h"
#include "device/loop.h"
#include "device/seven_bar_device.h"
#include "io/report.h"
#include "studies/seven_bar_margins.h"

namespace handloop::studies {
namespace {

constexpr double kMean_s = 0.002;
constexpr double kSlowCutoff_Hz = 5.0;
constexpr double kShortest_s = 8.0;  ///< of a run whose forces can be compared with those of no environment
constexpr std::uint64_t kLongestTrace = 1'000'000;
constexpr std::array<const char*, 2> kAxis{"x (forwards)", "y (upwards)"};

io::Plot over_time(const std::string& title, const std::string& y_label) {
  io::Plot plot;
  plot.title = title;
  plot.x_label = "time (s)";
  plot.y_label = y_label;
  return plot;
}

std::vector<double> scaled(std::vector<double> values, double factor) {
  for (auto& value : values) value *= factor;
  return values;
}

std::vector<double> cut(const std::vector<double>& values, std::size_t edge) {
  return {values.begin() + static_cast<std::ptrdiff_t>(edge), values.end() - static_cast<std::ptrdiff_t>(edge)};
}

io::Plot slope_plot(std::size_t axis, int figure, const std::vector<double>& difference,
                    const std::vector<double>& environment, double wanted, const Slope& slope) {
  io::Plot plot;
  plot.title = fmt::format("Figure {}: f_e against f_h - f_h*, {}", figure, kAxis[axis]);
  plot.x_label = "f_h - f_h* (N)";
  plot.y_label = "f_e (N)";
  io::Series points{.label = fmt::format("simulated, slope {:.3f}", slope.value)};
  points.style = io::Series::Style::points;
  for (std::size_t k = 0; k < difference.size(); k += 10) {
    points.x.push_back(difference[k]);
    points.y.push_back(environment[k]);
  }
  double reach = 0.0;
  for (const double value : difference) reach = std::max(reach, std::abs(value));
  plot.series.push_back({.label = fmt::format("slope {:g}", wanted),
                         .x = {-reach, reach},
                         .y = {-reach * wanted, reach * wanted},
                         .colour = io::Colour::orange});
  plot.series.insert(plot.series.begin(), points);
  return plot;
}

/// alpha's own slope where it is a constant diagonal, else nothing.
double wanted_slope(const models::Scenario& scenario, std::size_t axis) {
  const auto alpha = control::alpha_of(scenario.force_amplifier);
  return -alpha.entries[axis][axis](0.0).real();
}

}  // namespace

SevenBarRunTrace::SevenBarRunTrace(double sample_time_s, const Eigen::Vector3d& home_m)
    : sample_time_s_(sample_time_s),
      home_m_(home_m),
      every_(std::max<std::uint64_t>(1, static_cast<std::uint64_t>(std::lround(kMean_s / sample_time_s)))),
      slow_pole_(std::exp(-2 * std::numbers::pi * kSlowCutoff_Hz * sample_time_s)) {}

void SevenBarRunTrace::reserve(std::uint64_t samples) {
  every_ *= samples / (every_ * kLongestTrace) + 1;
  time_s.reserve(samples / every_ + 1);
  for (auto* signals : {&position_m, &hand_N, &environment_N}) {
    for (auto& signal : *signals) signal.reserve(samples / every_ + 1);
  }
}

const device::StepRecord& SevenBarRunTrace::add(const device::StepRecord& record) noexcept {
  for (int i = 0; i < 2; ++i) {
    sum_(i, 0) += record.tip_m[2 * i] - home_m_[2 * i];
    sum_(i, 1) -= record.sensed_force_N[2 * i];
    sum_(i, 2) -= record.environment_force_N[2 * i];
  }
  if (++in_mean_ == every_ && time_s.size() < time_s.capacity()) {
    const double share = 1.0 / static_cast<double>(every_);
    time_s.push_back(static_cast<double>(record.reading.time_ns) * 1e-9);
    for (std::size_t i = 0; i < 2; ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      position_m[i].push_back(share * sum_(row, 0));
      hand_N[i].push_back(share * sum_(row, 1));
      environment_N[i].push_back(share * sum_(row, 2));
    }
    sum_.setZero();
    in_mean_ = 0;
  }
  slow_m_per_s_ = slow_pole_ * slow_m_per_s_ + (1.0 - slow_pole_) * record.velocity_m_per_s;
  judged_ = record;
  judged_.velocity_m_per_s -= slow_m_per_s_;
  return judged_;
}

SevenBarRunTrace trace_of(const models::Scenario& scenario) {
  device::SevenBarDevice device(scenario);
  const control::SevenBarMechanism mechanism(control::seven_bar_of(scenario));
  auto controller = control::make_force_amplifier(scenario);
  const Eigen::Vector3d home = mechanism.at(device::pose_rad(scenario)).tip_m;
  device::Loop loop(device::loop_config(scenario, home), device.description(), mechanism, controller);
  const auto steps = static_cast<std::uint64_t>(std::llround(scenario.run.duration_s / scenario.loop.sample_time_s));
  SevenBarRunTrace trace(scenario.loop.sample_time_s, home);
  trace.reserve(steps);
  device.start();
  for (std::uint64_t k = 0; k < steps && loop.fault().fault == device::Fault::none; ++k) trace.add(loop.step(device));
  return trace;
}

SevenBarFigures seven_bar_figures(const models::Scenario& scenario, const SevenBarRunTrace& trace, bool stable) {
  SevenBarFigures result;
  const double T = trace.sample_time_s();
  const auto add = [&](const std::string& name, io::Plot plot) { result.plots.emplace_back(name, std::move(plot)); };
  const auto line = [&](const std::string& label, const std::vector<double>& y, io::Colour colour) {
    return io::Series{.label = label, .x = trace.time_s, .y = y, .colour = colour, .width = 1.2};
  };
  for (std::size_t i = 0; i < 2; ++i) {
    if (!stable && i == 0) continue;
    auto plot = over_time(fmt::format("Figure {}: motion along {}", stable ? 9 + static_cast<int>(i) : 17, kAxis[i]),
                          "position (mm)");
    plot.series.push_back(line("", scaled(trace.position_m[i], 1e3), io::Colour::blue));
    add(fmt::format("position_{}", i == 0 ? "x" : "y"), plot);
  }
  const bool long_enough = static_cast<double>(trace.time_s.size()) * T >= kShortest_s;
  result.compared = stable && long_enough && scenario.arm.attached && scenario.force_amplifier.hand_leaves_s == 0.0 &&
                    scenario.force_amplifier.load_kg > 0.0;
  NoEnvironment bare;
  if (result.compared) bare = without_environment(scenario, trace.position_m, T);
  result.tracking_error = bare.tracking_error;
  const auto edge = static_cast<std::size_t>(bare.edge_s / T);
  for (std::size_t i = 0; i < 2; ++i) {
    if (!stable && i == 0) continue;
    const int first = i == 0 ? 11 : 14;
    const std::string axis = i == 0 ? "x" : "y";
    auto force = over_time(fmt::format("Figure {}: hand force f_h along {}", stable ? first : 18, kAxis[i]), "f_h (N)");
    force.series.push_back(line("", trace.hand_N[i], io::Colour::blue));
    add("hand_force_" + axis, force);
    if (!result.compared) continue;
    std::vector<double> difference(trace.time_s.size()), expected(trace.time_s.size());
    const double slope = wanted_slope(scenario, i);
    for (std::size_t k = 0; k < difference.size(); ++k) {
      difference[k] = trace.hand_N[i][k] - bare.hand_N[i][k];
      expected[k] = trace.environment_N[i][k] / slope;
    }
    auto both = over_time(fmt::format("Figure {}: f_h - f_h* and f_e along {}", first + 1, kAxis[i]), "force (N)");
    both.x_range = {{trace.time_s[edge], trace.time_s[trace.time_s.size() - 1 - edge]}};
    both.series.push_back(line("f_e", trace.environment_N[i], io::Colour::grey));
    both.series.push_back(line("f_h - f_h*", difference, io::Colour::blue));
    auto model = line("-R f_e", expected, io::Colour::orange);
    model.dashed = true;
    both.series.push_back(model);
    add("force_difference_" + axis, both);
    const auto x = cut(difference, edge), y = cut(trace.environment_N[i], edge);
    result.slopes[i] = force_slope(x, y);
    add("force_slope_" + axis, slope_plot(i, first + 2, x, y, slope, result.slopes[i]));
  }
  return result;
}

void write_seven_bar_report(const std::filesystem::path& path, const RunOptions& options, const RunOutcome& outcome,
                            const SevenBarRunTrace& trace) {
  const auto& s = options.scenario;
  using Mood = io::Figure::Mood;
  io::Report report(fmt::format("Run of {}", s.name), s.description);
  const auto figures = seven_bar_figures(s, trace, outcome.stable);
  const auto margins = seven_bar_margins(s);
  report.section("Outcome");
  std::vector<io::Figure> cards{{"loop", outcome.stable ? "stable" : "not stable", outcome.why_unstable,
                                 outcome.stable ? Mood::good : Mood::bad}};
  for (std::size_t i = 0; i < 2 && figures.compared; ++i) {
    cards.push_back(
        {fmt::format("slope of f_e along {}", i == 0 ? "x" : "y"), fmt::format("{:.3f}", figures.slopes[i].value),
         fmt::format("alpha wants {:g}; explains {:.2f} %", wanted_slope(s, i), 100 * figures.slopes[i].explained)});
  }
  for (std::size_t i = 0; i < 2; ++i) {
    if (const auto& limit = margins.axes[i].modelled) {
      cards.push_back({fmt::format("alpha limit along {}", i == 0 ? "x" : "y"), fmt::format("{:.2f}", limit->factor),
                       "predicted, S_h and S_e included"});
    }
  }
  report.figures(cards);
  if (outcome.session.fault.fault != device::Fault::none) {
    report.callout(io::Report::Tone::warning, describe(outcome.session.fault) + "; the last 2 s are in `fault.csv`");
  }
  for (const auto& note : outcome.notes) report.callout(io::Report::Tone::note, note);
  report.callout(io::Report::Tone::assumption, kSevenBarAssumption);
  report.section(outcome.stable ? "Their experiment" : "Their unstable experiment");
  report.paragraph(outcome.stable
                       ? "Figures are numbered as in Kazerooni and Her (1994). A simulated hand moves the load "
                         "irregularly; x is forwards, y upwards; f_h and f_e are forces on the device at its handle."
                       : "Figures 17 and 18 of Kazerooni and Her (1994): the device where alpha is beyond its limit.");
  for (const auto& [name, plot] : figures.plots) report.plot(plot);
  if (figures.compared) {
    report.paragraph(
        fmt::format("f_h* is the force of a hand that moves the device without its load through the same "
                    "trajectory, simulated: it was followed within {:.2f} % (rms). The first and last 2 s "
                    "are left out of the comparison.",
                    100 * figures.tracking_error));
  }
  report.section("Predicted");
  report.code(to_text(margins));
  report.section("Timing");
  report.paragraph(fmt::format(
      "{} samples of {:g} ms; one pass of the loop took {} us (p50), {} us (p99.9); {} x real "
      "time.",
      outcome.session.steps, 1e3 * s.loop.sample_time_s, io::pretty(outcome.session.compute.percentile_us(0.5)),
      io::pretty(outcome.session.compute.percentile_us(0.999)), io::pretty(outcome.real_time_factor, 3)));
  report.write(path);
}

}  // namespace handloop::studies
