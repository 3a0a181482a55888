#include <fmt/format.h>

#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "cli/commands.h"
#include "cli/progress_bar.h"
#include "models/errors.h"
#include "studies/identification.h"

namespace handloop::cli {
namespace {

struct Options {
  std::vector<std::string> recordings;
  std::string index, method = "unbiased", spectra = "welch", axis, hold = "auto", percentiles = "ecdf", out;
  io::RecordingOptions columns;
  bool skip_bad = false;
  unsigned jobs = 0;
};

std::optional<identify::Hold> parse_hold(const std::string& text) {
  if (text == "auto") return std::nullopt;
  for (const auto hold : {identify::Hold::continuous, identify::Hold::zero_order, identify::Hold::first_order}) {
    if (text == identify::hold_name(hold)) return hold;
  }
  throw InputError(fmt::format("--hold: '{}' is not known; give auto, continuous, zero_order or first_order", text));
}

void print_summary(const studies::Identification& result, const std::string& out) {
  fmt::print("{} recordings, method {}\n", result.trials.size(), studies::method_name(result.method));
  for (const auto& set : result.sets) {
    fmt::print("axis {}: {} recordings\n", set.axis ? models::axis_name(*set.axis) : "not given", set.trials.size());
    for (std::size_t p = 0; p < 5; ++p) {
      const auto& s = set.statistics[p];
      std::string line =
          set.trials.size() == 1
              ? fmt::format("  {:<12} {:>10.4g}", models::kArmParameterNames[p], s.mean)
              : fmt::format("  {:<12} {:>10.4g} +- {:<9.3g} ({:.4g} to {:.4g})", models::kArmParameterNames[p], s.mean,
                            s.standard_deviation, s.minimum, s.maximum);
      if (set.trials.size() == 1) {
        const auto& fit = result.trials[set.trials[0]].by(result.method).fit;
        line += fmt::format("   95 %: {:.4g} to {:.4g}", fit.low95[p], fit.high95[p]);
      }
      if (set.truth) line += fmt::format("   mean bias {:+.2f} %", 100 * set.bias[p]);
      fmt::print("{}\n", line);
    }
  }
  std::size_t remarks = result.skipped.size();
  for (const auto& t : result.trials) remarks += t.doubts.size() + t.by(result.method).fit.warnings.size();
  for (const auto& s : result.skipped) fmt::print("left out: {}\n", s);
  if (result.trials.size() <= 3) {
    for (const auto& t : result.trials) {
      for (const auto& w : t.doubts) fmt::print("{}: {}\n", t.name, w);
      for (const auto& w : t.by(result.method).fit.warnings) fmt::print("{}: {}\n", t.name, w);
    }
  } else if (remarks > 0) {
    fmt::print("{} remarks in the report: what the recordings do not determine\n", remarks);
  }
  if (!out.empty()) fmt::print("{0}/fits.csv, {0}/statistics.json, {0}/report.html\n", out);
}

void run(const Options& options) {
  if (options.recordings.empty() == options.index.empty()) {
    throw InputError("identify: name recordings or their directory, or give --index DIR/index.csv (one of the two)");
  }
  studies::IdentificationRequest request;
  request.recordings.assign(options.recordings.begin(), options.recordings.end());
  request.index = options.index;
  if (!options.axis.empty()) request.axis = models::parse_axis(options.axis);
  if (options.method == "paper") request.method = studies::IdentificationMethod::paper;
  if (options.spectra == "local") request.spectra = studies::SpectralEstimate::local;
  request.columns = options.columns;
  request.hold = parse_hold(options.hold);
  request.percentiles = models::parse_percentile_reading(options.percentiles);
  request.skip_bad = options.skip_bad;
  request.threads = options.jobs;
  const auto result = studies::run_identification(request, progress_bar("identify"));
  if (!options.out.empty()) studies::write_identification(result, options.out);
  print_summary(result, options.out);
}

}  // namespace

void add_identify_command(CLI::App& program) {
  auto* command =
      program.add_subcommand("identify", "Fit arms to recordings; their statistics, variability and envelopes");
  const auto options = std::make_shared<Options>();
  command->add_option("recordings", options->recordings,
                      "CSV or .mat recordings of force and position, or a directory of them");
  command->add_option("--index", options->index,
                      "index.csv of an experiment: trial,subject,grip,axis beside its recordings");
  command
      ->add_option("--method", options->method,
                   "paper: as Fu and Cavusoglu; unbiased (default): hold and leakage accounted for")
      ->check(CLI::IsMember({"paper", "unbiased"}));
  command
      ->add_option("--spectra", options->spectra,
                   "what the paper's method fits: welch (default), or local polynomials, without leakage")
      ->check(CLI::IsMember({"welch", "local"}));
  command->add_option("--axis", options->axis, "axis of the named recordings: x, y or z");
  command->add_option(
      "--hold", options->hold,
      "force between samples: auto (default: the recording decides), continuous, zero_order, first_order");
  command->add_option("--percentiles", options->percentiles, "what the CI ends are: ecdf (default) or central");
  command->add_option("--time", options->columns.time, "time column, by name or number");
  command->add_option("--force", options->columns.force, "force column");
  command->add_option("--position", options->columns.position, "position column");
  command->add_option("--rate", options->columns.rate_Hz, "sampling rate in Hz where there is no time column");
  command->add_flag("--skip-bad", options->skip_bad, "go on without recordings that cannot be used, and name them");
  command->add_option("--jobs", options->jobs, "threads (default: all cores)");
  command->add_option("--out", options->out, "directory for fits.csv, statistics.json and report.html");
  command->footer("Example: handloop identify --index out/experiment/index.csv --out out/identify");
  command->callback([options] { run(*options); });
}

}  // namespace handloop::cli
