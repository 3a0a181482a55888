#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "cli/commands.h"
#include "cli/progress_bar.h"
#include "cli/scenario_argument.h"
#include "control/transfer_loop.h"
#include "models/arm_population.h"
#include "models/errors.h"
#include "studies/margins_cases.h"
#include "studies/margins_json.h"
#include "studies/scenario_margins.h"
#include "studies/seven_bar_margins.h"
#include "studies/seven_bar_plots.h"
#include "studies/stability_figures.h"

namespace handloop::cli {
namespace {

struct Options {
  std::string cases, out, json, num, den, scenario, percentiles = "ecdf";
  std::size_t arms = 2000;
  std::uint64_t seed = 1;
  bool quick = false, figures = false;
  double sample_time_s = 0;
  double delay_s = 0;
  unsigned jobs = 0;
};

/// "1,2.5,3" to numbers. Throws InputError naming the option and the part that is not a number.
std::vector<double> coefficients(const std::string& text, const char* option) {
  std::vector<double> values;
  std::size_t begin = 0;
  while (begin <= text.size()) {
    std::size_t end = std::min(text.find(',', begin), text.size());
    std::size_t first = begin;
    while (first < end && (text[first] == ' ' || text[first] == '+')) ++first;
    std::size_t last = end;
    while (last > first && text[last - 1] == ' ') --last;
    double value = 0;
    const auto [stop, error] = std::from_chars(text.data() + first, text.data() + last, value);
    if (error != std::errc() || stop != text.data() + last || first == last) {
      throw InputError(fmt::format("{}: '{}' is not a number; give coefficients as in 1,2.5,3 (highest power first)",
                                   option, text.substr(begin, end - begin)));
    }
    values.push_back(value);
    begin = end + 1;
  }
  return values;
}

void print_table(const control::TransferMargins& result, bool discrete) {
  const auto& m = result.margins;
  if (!m.stable) {
    fmt::print("UNSTABLE: the closed loop has a pole {} ({} {:.9g}); it has no margins\n",
               discrete ? "on or outside the unit circle" : "on or right of the imaginary axis",
               discrete ? "largest modulus" : "largest real part", discrete ? m.rho : result.abscissa);
    return;
  }
  const auto row = [](const char* name, const std::string& value, double at) {
    if (std::isnan(at))
      fmt::print("  {:<16} {:<22}\n", name, value);
    else
      fmt::print("  {:<16} {:<22} at {:.6g} rad/s\n", name, value, at);
  };
  fmt::print("stable; {} {:.9g}\n", discrete ? "largest pole modulus" : "largest real part of a pole",
             discrete ? m.rho : result.abscissa);
  row("gain up", fmt::format("x {:.6g}", m.gain_up), m.gain_up_at_rad_per_s);
  row("gain down", fmt::format("x {:.6g}", m.gain_down), m.gain_down_at_rad_per_s);
  row("phase", fmt::format("{:.6g} deg", m.phase_deg), m.phase_at_rad_per_s);
  row("delay", fmt::format("{:.6g} s", m.delay_s), m.delay_at_rad_per_s);
  row("modulus |1+L|", fmt::format("{:.6g}", m.modulus), m.modulus_at_rad_per_s);
  const auto disk = control::disk_guarantee(m.disk_alpha);
  row("disk", fmt::format("alpha {:.6g}", m.disk_alpha), m.disk_at_rad_per_s);
  fmt::print("  at once:         gain x {:.4g} to {:.4g}, phase +-{:.4g} deg\n", disk.gain_low, disk.gain_high,
             disk.phase_deg);
}

void run_transfer(const Options& options) {
  if (options.num.empty() || options.den.empty()) {
    throw InputError("margins: --num and --den go together; give both as in --num 25 --den 1,10,10,10");
  }
  control::TransferLoop loop{
      coefficients(options.num, "--num"), coefficients(options.den, "--den"), {}, options.delay_s};
  if (options.sample_time_s != 0) loop.sample_time_s = options.sample_time_s;
  const auto result = control::evaluate(loop);
  if (options.json.empty()) return print_table(result, loop.sample_time_s.has_value());
  studies::write_json(studies::to_json(result), options.json);
}

void run_scenario(const Options& options) {
  if (options.arms < 1) throw InputError("--arms: give one or more");
  studies::ScenarioMarginsRequest request;
  request.arms = options.arms;
  request.seed = options.seed;
  request.percentiles = models::parse_percentile_reading(options.percentiles);
  request.permitted_stiffness = !options.quick;
  request.jobs = options.jobs;
  const auto scenario = read_scenario_argument(options.scenario);
  if (options.figures) {
    if (options.out.empty()) throw InputError("margins --figures: say where the pictures go, --out DIR");
    if (scenario.device.model == models::DeviceModel::seven_bar) {
      return studies::write_seven_bar_figures(scenario, options.out);
    }
    return studies::write_stability_figures(scenario, options.out);
  }
  if (scenario.device.model == models::DeviceModel::seven_bar) {
    if (!options.out.empty()) studies::write_seven_bar_margins(scenario, options.out);
    const auto seven_bar = studies::seven_bar_margins(scenario);
    if (!options.json.empty()) studies::write_json(studies::to_json(seven_bar), options.json);
    if (options.json != "-") fmt::print("{}", studies::to_text(seven_bar));
    return;
  }
  const auto result = studies::scenario_margins(scenario, request, progress_bar("margins"));
  if (!options.out.empty()) studies::write_scenario_margins(result, request, options.out);
  if (!options.json.empty()) studies::write_json(studies::to_json(result), options.json);
  if (options.json != "-") fmt::print("{}", studies::to_text(result));
}

void run(const Options& options) {
  const int asked = !options.cases.empty() + (!options.num.empty() || !options.den.empty()) + !options.scenario.empty();
  if (asked != 1) {
    throw InputError("margins: give one of --scenario FILE, --cases FILE.csv, or --num with --den");
  }
  if (!options.cases.empty()) {
    if (options.out.empty()) throw InputError("margins --cases: say where the results go, --out FILE.csv");
    const auto rows = studies::margins_of_case_file(options.cases, options.out, options.jobs);
    fmt::print("{} loops to {}\n", rows, options.out);
    return;
  }
  if (!options.scenario.empty()) return run_scenario(options);
  run_transfer(options);
}

}  // namespace

void add_margins_command(CLI::App& program) {
  auto* command =
      program.add_subcommand("margins", "Stability margins of a scenario, a table of loops or any transfer function");
  const auto options = std::make_shared<Options>();
  command->add_option("--scenario", options->scenario, "scenario file: margins, robustness, passivity, population");
  command->add_option("--arms", options->arms, "sampled arms of a scenario")->capture_default_str();
  command->add_option("--seed", options->seed, "of the sampled arms")->capture_default_str();
  command->add_option("--percentiles", options->percentiles, "how Table III's ends are read: ecdf or central")
      ->capture_default_str();
  command->add_flag("--figures", options->figures,
                    "only draw the pictures of docs/stability.md (docs/seven_bar.md) for the scenario, into --out DIR");
  command->add_flag("--quick", options->quick, "do not search for the stiffness each test permits");
  command->add_option("--cases", options->cases,
                      "CSV of loops: id,axis,M,k1,k2,b1,b2,K,B (and m,b,T,delay_samples,cutoff_Hz)");
  command->add_option("--out", options->out,
                      "results: a CSV file for --cases, a directory with a report for --scenario");
  command->add_option("--num", options->num, "numerator of a loop transfer function, highest power first, as in 1,2,3");
  command->add_option("--den", options->den, "its denominator");
  command->add_option("--sample-time", options->sample_time_s, "seconds; makes --num and --den polynomials in z");
  command->add_option("--delay", options->delay_s, "seconds of dead time behind a continuous --num and --den");
  command->add_option("--json", options->json, "machine form to this file, or - for standard output");
  command->add_option("--jobs", options->jobs, "threads (default: all cores)");
  command->footer("Example: handloop margins --num 25 --den 1,10,10,10 --json -");
  command->callback([options] { run(*options); });
}

}  // namespace handloop::cli
