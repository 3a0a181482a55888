#include <fmt/format.h>

#include <memory>

#include "cli/commands.h"
#include "cli/scenario_argument.h"
#include "device/fault_injection.h"
#include "device/stop_signals.h"
#include "io/output.h"
#include "models/errors.h"
#include "studies/run.h"
#include "studies/run_report.h"

namespace handloop::cli {
namespace {

struct Options {
  std::string scenario, device = "sim", out, key, inject, json;
  bool realtime = false, list_faults = false;
  double duration_s = 0.0;
  std::optional<std::uint64_t> seed;
};

void print(const studies::RunOptions& options, const studies::RunOutcome& outcome) {
  const auto& session = outcome.session;
  fmt::print("{}: {} samples of {} on {}, {}\n", options.scenario.name, session.steps,
             fmt::format("{:.4g} ms",
                         1e3 * outcome.duration_s / static_cast<double>(std::max<std::uint64_t>(session.steps, 1))),
             outcome.device, outcome.stable ? "stable" : "NOT STABLE: " + outcome.why_unstable);
  fmt::print("one pass of the loop: p50 {:.2f}, p99 {:.2f}, p99.9 {:.2f}, max {:.1f} us; {:.1f} x real time\n",
             session.compute.percentile_us(0.5), session.compute.percentile_us(0.99),
             session.compute.percentile_us(0.999), session.compute.max_us(), outcome.real_time_factor);
  if (session.wake.count() > 0) {
    fmt::print("wake-ups late by: p50 {:.1f}, p99 {:.1f}, p99.9 {:.1f}, max {:.1f} us; {} deadlines missed\n",
               session.wake.percentile_us(0.5), session.wake.percentile_us(0.99), session.wake.percentile_us(0.999),
               session.wake.max_us(), session.timing.missed);
  }
  for (const auto& note : outcome.notes) fmt::print("{}\n", note);
  for (const auto& refused : outcome.realtime_refused) fmt::print(stderr, "handloop: not granted: {}\n", refused);
}

void run(const Options& given) {
  if (given.list_faults) {
    for (const auto& fault : device::injectable_faults()) fmt::print("{:<30} {}\n", fault.name, fault.meaning);
    return;
  }
  studies::RunOptions options;
  options.scenario = read_scenario_argument(given.scenario);
  options.device = given.device;
  options.realtime = given.realtime;
  options.out = given.out;
  options.inject = given.inject;
  if (given.out.empty()) throw InputError("run: give the directory for its results, for example --out out/run");
  if (!given.key.empty()) options.key = given.key;
  if (given.duration_s != 0.0) options.scenario.run.duration_s = given.duration_s;
  if (given.seed) options.scenario.run.seed = *given.seed;
  options.stop = &device::stop_on_signals();
  const auto outcome = studies::run(options);
  if (given.json != "-") print(options, outcome);
  if (!given.json.empty()) io::write_file_atomically(given.json, studies::run_summary_json(options, outcome));
  if (!outcome.log_error.empty()) {
    throw RequirementError(
        fmt::format("{}/log.csv: the log ends where it could not be written: {}", given.out, outcome.log_error));
  }
  if (outcome.session.fault.fault != device::Fault::none) {
    throw RequirementError(
        fmt::format("{}; the last 2 s are in {}/fault.csv", studies::describe(outcome.session.fault), given.out));
  }
}

}  // namespace

void add_run_command(CLI::App& program) {
  auto options = std::make_shared<Options>();
  options->scenario = "scenes/phantom_wall.toml";
  auto* command = program.add_subcommand("run", "The closed loop on a simulated or real device, with its log");
  command->add_option("scenario", options->scenario, "Scenario file (default: the Phantom at a virtual wall)");
  command->add_option("--device", options->device, "sim, udp://HOST:PORT, comedi[:FILE.toml] or replay:FILE")
      ->capture_default_str();
  command->add_flag("--realtime", options->realtime,
                    "Pace the loop by the clock, with real-time priority if permitted");
  command->add_option("--duration", options->duration_s, "Seconds (default: the scenario's)");
  command->add_option("--seed", options->seed, "Of all noise (default: the scenario's)");
  command->add_option("--key", options->key, "File with the key that authenticates udp packets");
  command->add_option("--inject", options->inject, "Break the device on purpose: NAME or NAME@SAMPLE");
  command->add_option("--json", options->json, "The summary into this file as well (-: standard output)");
  command->add_flag("--list-faults", options->list_faults, "Names for --inject, and nothing else");
  command->add_option("--out", options->out, "Directory for log.csv, summary.json, report.html");
  command->footer("Example: handloop run scenes/phantom_wall.toml --duration 5 --out out/run");
  command->callback([options] { run(*options); });
}

}  // namespace handloop::cli
