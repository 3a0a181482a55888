#include "studies/run_report.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "io/report.h"
#include "studies/run.h"

namespace handloop::studies {
namespace {

using Json = nlohmann::ordered_json;
using io::pretty;

io::Plot position_plot(const RunOptions& options, const RunTrace& trace) {
  io::Plot plot;
  plot.title = fmt::format("Tip along {}", models::axis_name(options.scenario.wall.axis));
  plot.x_label = "time (s)";
  plot.y_label = "position (mm)";
  std::vector<double> mm(trace.position_m);
  for (auto& value : mm) value *= 1e3;
  plot.series.push_back({.label = "tip", .x = trace.time_s, .y = mm, .colour = io::Colour::blue});
  plot.horizontal.push_back({.at = 1e3 * options.scenario.wall.position_m, .label = "wall"});
  return plot;
}

io::Plot force_plot(const RunTrace& trace) {
  io::Plot plot;
  plot.title = "Force on the hand";
  plot.x_label = "time (s)";
  plot.y_label = "force (N)";
  plot.series.push_back({.label = "sensed", .x = trace.time_s, .y = trace.sensed_N, .colour = io::Colour::grey});
  plot.series.push_back({.label = "written", .x = trace.time_s, .y = trace.written_N, .colour = io::Colour::orange});
  return plot;
}

io::Plot energy_plot(const RunOptions& options, const RunTrace& trace) {
  io::Plot plot;
  plot.title = "Passivity observer";
  plot.x_label = "time (s)";
  plot.y_label = "energy given to the hand (mJ)";
  std::vector<double> mJ(trace.energy_J);
  for (auto& value : mJ) value *= 1e3;
  plot.series.push_back({.label = "", .x = trace.time_s, .y = mJ, .colour = io::Colour::green});
  (void)options;
  return plot;
}

}  // namespace

void RunTrace::add(const device::StepRecord& record, int row, double home_m) {
  if (seen++ % every != 0) return;
  time_s.push_back(static_cast<double>(record.reading.time_ns) * 1e-9);
  position_m.push_back(record.tip_m[row] - home_m);
  wanted_N.push_back(record.wanted_force_N[row]);
  written_N.push_back(record.written_force_N[row]);
  sensed_N.push_back(record.sensed_force_N[row]);
  energy_J.push_back(record.energy_J);
}

std::string run_summary_json(const RunOptions& options, const RunOutcome& outcome) {
  const auto& session = outcome.session;
  Json faults = Json::array();
  if (session.fault.fault != device::Fault::none) {
    const auto& info = device::fault_info(session.fault.fault);
    faults.push_back({{"name", info.name},
                      {"meaning", info.meaning},
                      {"sample", session.fault.sample},
                      {"time_s", static_cast<double>(session.fault.time_ns) * 1e-9},
                      {"value", session.fault.value},
                      {"limit", session.fault.limit},
                      {"unit", info.unit}});
  }
  Json json{{"scenario", options.scenario.name},
            {"device", outcome.device},
            {"seed", options.scenario.run.seed},
            {"stable", outcome.stable},
            {"why_unstable", outcome.why_unstable},
            {"faults", faults},
            {"steps", session.steps},
            {"duration_s", outcome.duration_s},
            {"stopped_early", session.stopped_early},
            {"realtime", options.realtime},
            {"deadline_misses", session.timing.missed},
            {"longest_miss", session.timing.longest_miss},
            {"missing_samples", session.missing_samples},
            {"stale_samples", session.stale_samples},
            {"clipped_samples", session.clipped_samples},
            {"p50_us", session.compute.percentile_us(0.5)},
            {"p99_us", session.compute.percentile_us(0.99)},
            {"p99_9_us", session.compute.percentile_us(0.999)},
            {"max_us", session.compute.max_us()},
            {"wake_p50_us", session.wake.percentile_us(0.5)},
            {"wake_p99_us", session.wake.percentile_us(0.99)},
            {"wake_p99_9_us", session.wake.percentile_us(0.999)},
            {"wake_max_us", session.wake.max_us()},
            {"sim_steps_per_s", outcome.sim_steps_per_s},
            {"real_time_factor", outcome.real_time_factor},
            {"realtime_refused", outcome.realtime_refused},
            {"notes", outcome.notes}};
  return json.dump(2) + "\n";
}

void write_run_report(const std::filesystem::path& path, const RunOptions& options, const RunOutcome& outcome,
                      const RunTrace& trace) {
  const auto& s = options.scenario;
  const auto& session = outcome.session;
  using Mood = io::Figure::Mood;
  io::Report report(fmt::format("Run of {}", s.name), s.description);
  report.section("Outcome");
  report.figures(
      {{"loop", outcome.stable ? "stable" : "not stable", outcome.why_unstable,
        outcome.stable ? Mood::good : Mood::bad},
       {"device time", fmt::format("{:.3g} s", outcome.duration_s), fmt::format("{} samples", session.steps)},
       {"one pass, p99.9", fmt::format("{:.3g} us", session.compute.percentile_us(0.999)), "of the loop alone"},
       {"real-time factor", pretty(outcome.real_time_factor, 3), options.realtime ? "paced by the clock" : "unpaced"}});
  if (session.fault.fault != device::Fault::none) {
    report.callout(io::Report::Tone::warning, describe(session.fault) + "; the last 2 s are in `fault.csv`");
  }
  for (const auto& note : outcome.notes) report.callout(io::Report::Tone::note, note);
  report.section("Signals");
  report.plot(position_plot(options, trace));
  report.plot(force_plot(trace));
  report.plot(energy_plot(options, trace), "Below zero the wall has taken more than it gave: it is passive so far.");
  report.section("Loop");
  report.table({.columns = {"what", "value"},
                .rows = {{"stiffness", fmt::format("{} N/m", s.loop.stiffness_N_per_m)},
                         {"damping", fmt::format("{} N s/m", s.loop.damping_Ns_per_m)},
                         {"velocity filter", fmt::format("{} Hz", s.loop.cutoff_Hz)},
                         {"sample time", fmt::format("{} ms", 1e3 * s.loop.sample_time_s)},
                         {"delay in the loop", fmt::format("{} samples", s.loop.delay_samples)},
                         {"wall", fmt::format("{} axis, {}", models::axis_name(s.wall.axis),
                                              s.wall.bilateral ? "bilateral spring" : "one-sided")},
                         {"device", outcome.device},
                         {"seed", std::to_string(s.run.seed)}}});
  report.section("Timing");
  const auto row = [](const std::string& name, const device::LatencyHistogram& h) {
    return std::vector<std::string>{name, pretty(h.percentile_us(0.5)), pretty(h.percentile_us(0.99)),
                                    pretty(h.percentile_us(0.999)), pretty(h.max_us())};
  };
  io::Table timing{.columns = {"microseconds", "p50", "p99", "p99.9", "max"},
                   .rows = {row("one pass of the loop, without the device", session.compute)}};
  if (session.wake.count() > 0) timing.rows.push_back(row("wake-up after its due time", session.wake));
  report.table(timing);
  report.paragraph(
      fmt::format("{} deadlines missed, at most {} in a row; {} samples missing, {} out of order; the "
                  "envelope clipped {} samples.",
                  session.timing.missed, session.timing.longest_miss, session.missing_samples, session.stale_samples,
                  session.clipped_samples));
  for (const auto& refused : outcome.realtime_refused) {
    report.callout(io::Report::Tone::warning, "not granted by this system: " + refused);
  }
  report.write(path);
}

}  // namespace handloop::studies
