#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <memory>

#include "cli/commands.h"
#include "io/output.h"
#include "io/scenario_file.h"
#include "models/errors.h"
#include "sim/scene_file.h"
#include "studies/sweep.h"
#include "studies/sweep_compare.h"
#include "studies/sweep_ranks.h"
#include "studies/sweep_truth.h"

namespace handloop::cli {
namespace {

struct Arguments {
  std::string scenario = (sim::scenes_directory() / "phantom_wall.toml").string();
  std::string gains, method = "margins", design = "grid", axes, percentiles = "ecdf", keep = "auto", compare, json;
  studies::SweepSettings settings;
  studies::SweepRun run;
  std::string out;
  bool scenario_given = false;
  std::uint64_t truth_check = 0;
};

/// "1,234,567".
std::string grouped(std::uint64_t number) {
  std::string text = std::to_string(number);
  for (std::ptrdiff_t i = static_cast<std::ptrdiff_t>(text.size()) - 3; i > 0; i -= 3)
    text.insert(static_cast<std::size_t>(i), ",");
  return text;
}

/// One line that rewrites itself on a terminal; nothing in a pipe.
studies::SweepProgress progress_line() {
  if (!isatty(STDERR_FILENO)) return {};
  return [](std::uint64_t done, std::uint64_t total, double seconds) {
    const double rate = seconds > 0 ? static_cast<double>(done) / seconds : 0;
    const std::string left =
        done >= total || rate <= 0 ? "" : fmt::format(", {:.0f} s left", static_cast<double>(total - done) / rate);
    fmt::print(stderr, "\r\033[K{} of {} evaluations ({:.0f} %), {} a second{}{}", grouped(done), grouped(total),
               total ? 100.0 * static_cast<double>(done) / static_cast<double>(total) : 100.0,
               grouped(static_cast<std::uint64_t>(rate)), left, done >= total ? "\n" : "");
    std::fflush(stderr);
  };
}

void print_outcome(const studies::SweepOutcome& outcome, const std::filesystem::path& out) {
  fmt::print("{} evaluations at {} points in {:.1f} s ({} were there before)\n", grouped(outcome.evaluations),
             grouped(outcome.points), outcome.seconds, grouped(outcome.evaluations - outcome.evaluated_now));
  for (const studies::RequirementOutcome& r : outcome.requirements)
    fmt::print("{}  {}: {}\n", r.met ? "met    " : "NOT MET", r.expression, r.detail);
  if (!outcome.comparison.empty()) fmt::print("{}", outcome.comparison);
  fmt::print("{}\n", (out / "report.html").string());
}

void compare_only(const Arguments& a) {
  studies::SweepStore old_sweep = studies::SweepStore::read(studies::sweep_database_path(a.compare));
  studies::SweepStore new_sweep = studies::SweepStore::read(studies::sweep_database_path(a.out));
  const studies::SweepComparison comparison = studies::compare_sweeps(old_sweep, new_sweep);
  fmt::print("{}", comparison.text());
  if (a.run.fail_on_regression && comparison.regressions() > 0)
    throw RequirementError(fmt::format("sweep: significantly fewer stable arms at {} points than in {}",
                                       comparison.regressions(), a.compare));
}

void sweep(Arguments& a) {
  if (!a.scenario_given && !a.compare.empty()) return compare_only(a);
  a.run.out = a.out;
  a.settings.scenario = io::read_scenario(a.scenario);
  a.settings.scenario_name = std::filesystem::path(a.scenario).stem().string();
  a.settings.stiffness = {a.settings.scenario.loop.stiffness_N_per_m, a.settings.scenario.loop.stiffness_N_per_m, 1};
  a.settings.damping = {a.settings.scenario.loop.damping_Ns_per_m, a.settings.scenario.loop.damping_Ns_per_m, 1};
  if (!a.gains.empty()) studies::parse_gain_ranges(a.gains, a.settings.stiffness, a.settings.damping);
  a.settings.method = studies::parse_sweep_method(a.method);
  a.settings.design = studies::parse_sweep_design(a.design);
  a.settings.percentiles = models::parse_percentile_reading(a.percentiles);
  if (a.axes == "all")
    a.settings.axes.assign(models::kAxes.begin(), models::kAxes.end());
  else
    for (std::size_t begin = 0; begin < a.axes.size();) {
      const std::size_t end = std::min(a.axes.find(',', begin), a.axes.size());
      a.settings.axes.push_back(models::parse_axis(a.axes.substr(begin, end - begin)));
      begin = end + 1;
    }
  if (a.truth_check > 0) {
    std::error_code error;
    std::filesystem::create_directories(a.run.out, error);
    if (error) throw InputError(a.out + ": cannot be made: " + error.message());
    const studies::TruthCheck check = studies::check_truth(a.settings, a.truth_check, a.run.jobs, progress_line());
    io::write_file_atomically(a.run.out / "truth.csv", check.csv());
    fmt::print("{}", check.text());
    return;
  }
  const double grid = static_cast<double>(a.settings.stiffness.count) * a.settings.damping.count;
  const double evaluations = static_cast<double>(a.settings.arms) * grid;
  if (a.keep != "auto" && a.keep != "all" && a.keep != "cells")
    throw InputError("sweep: --keep '" + a.keep + "' is not known; known are auto, all, cells");
  a.settings.keep_evaluations =
      a.keep == "all" || a.settings.method == studies::SweepMethod::mujoco || (a.keep == "auto" && evaluations <= 2e6);
  if (!a.compare.empty()) a.run.compare_with = a.compare;
  const std::optional<studies::SweepOutcome> outcome = studies::run_sweep(a.settings, a.run, progress_line());
  if (!outcome) return;
  print_outcome(*outcome, a.run.out);
  if (!outcome->requirements_met()) throw RequirementError("sweep: a requirement is not met");
}

}  // namespace

void add_sweep_command(CLI::App& program) {
  const auto a = std::make_shared<Arguments>();
  CLI::App* command = program.add_subcommand(
      "sweep",
      "How many of the people who may hold the device meet a stable wall, over gains, axes, delays and devices");
  CLI::Option* scenario =
      command->add_option("scenario", a->scenario, "Scenario file (default: scenes/phantom_wall.toml)");
  command->add_option("--arms", a->settings.arms, "Arms drawn from the population")->capture_default_str();
  command->add_option(
      "--gains", a->gains,
      "k=LO:HI:N,b=LO:HI:N in N/m and Ns/m; `:log` after N for logarithmic steps; default: the scenario's");
  command->add_option("--method", a->method, "margins | mujoco")->capture_default_str();
  command->add_option("--design", a->design, "grid | lhs | adaptive (follows the boundary of --boundary)")
      ->capture_default_str();
  command->add_option("--points", a->settings.points, "Gain pairs of --design lhs")->capture_default_str();
  command->add_option("--levels", a->settings.levels, "Halvings of the grid's cells, --design adaptive")
      ->capture_default_str();
  command->add_option("--boundary", a->settings.boundary, "Share of stable arms that --design adaptive follows")
      ->capture_default_str();
  command->add_option("--axes", a->axes, "x,y,z or all; default: the scenario's wall axis");
  command->add_option("--delays", a->settings.delays, "Samples of delay, for example 0,1,2; default: the scenario's")
      ->delimiter(',');
  command->add_option("--devices", a->settings.devices, "Devices: 1 is the nominal one, more are drawn about it")
      ->capture_default_str();
  command->add_option("--percentiles", a->percentiles, "Reading of Table III: ecdf | central")->capture_default_str();
  command->add_option("--seed", a->settings.seed, "Same seed, same results")->capture_default_str();
  command
      ->add_option("--keep", a->keep,
                   "all: a row for every arm at every point; cells: statistics only; auto: all up to 2 million")
      ->capture_default_str();
  command->add_option("--jobs", a->run.jobs, "Threads (default: all cores; 1 a rank under mpirun)");
  command->add_flag("--resume", a->run.resume, "Go on with an unfinished sweep in DIR");
  command->add_option("--out", a->out, "Folder for sweep.sqlite, summary.json, report.html, junit.xml")->required();
  command
      ->add_option("--require", a->run.requirements,
                   "Exit with 1 unless this holds, for example 'p_stable>=0.95' or 'gm_up_p05>=2@k=800,b=2'")
      ->take_all();
  command->add_option("--compare", a->compare,
                      "An earlier sweep (folder or database): says what changed and whether it is more than chance; "
                      "without a scenario, DIR is only compared");
  command->add_flag("--fail-on-regression", a->run.fail_on_regression,
                    "With --compare: exit with 1 where significantly fewer arms are stable");
  command->add_option(
      "--truth-check", a->truth_check,
      "Instead of a sweep: N arm and gain points near the boundary, linear loop against MuJoCo, into DIR/truth.csv");
  command->footer(
      "Example: handloop sweep scenes/phantom_wall.toml --arms 1000 --gains k=100:1500:15,b=0:4:5 --out out/sweep");
  command->callback([a, scenario] {
    a->scenario_given = scenario->count() > 0;
    try {
      sweep(*a);
    } catch (const InputError&) {
      if (studies::launched_rank() > 0) std::_Exit(2);  // rank 0 says the same: once is enough
      throw;
    }
  });
}

}  // namespace handloop::cli
