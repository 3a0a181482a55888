#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "cli/commands.h"
#include "cli/progress_bar.h"
#include "io/json.h"
#include "io/recording_file.h"
#include "models/errors.h"
#include "studies/explain.h"

namespace handloop::cli {
namespace {

struct Options {
  std::string recording, validate, base = "arm5", driven_by = "force", out, json, axis = "x";
  io::RecordingOptions columns;
  int max_effects = 3;
};

void run(const Options& given) {
  if (given.out.empty() && given.json.empty())
    throw InputError("explain: give the directory for its results, for example --out out/explain");
  studies::ExplainStudy study;
  study.recording = io::read_recording(given.recording, given.columns);
  if (!given.validate.empty()) study.validation = io::read_recording(given.validate, given.columns);
  study.options.base = given.base == "msd" ? models::BaseModel::msd : models::BaseModel::arm5;
  study.options.axis = models::parse_axis(given.axis);
  study.options.driven_by = given.driven_by == "position" ? identify::DrivenBy::position : identify::DrivenBy::force;
  study.options.search.max_effects = given.max_effects;
  const auto bar = progress_bar("explain");
  study.options.search.progress = [&](double share, const std::string&) {
    if (bar) bar(static_cast<std::size_t>(1000 * share), 1000);
  };
  const auto outcome = studies::run_explain(study);
  if (!given.out.empty()) studies::write_explanation(given.out, study, outcome);
  if (!given.json.empty()) io::write_json(studies::explain_json(study, outcome), given.json);
  if (given.json == "-") return;
  const auto& e = outcome.explanation;
  const auto unit =
      study.options.driven_by == identify::DrivenBy::force ? study.recording.position_unit : study.recording.force_unit;
  fmt::print("{}: {}", given.recording, identify::verdict_name(e.verdict));
  for (const auto& effect : e.effects) fmt::print("{}{}", &effect == &e.effects.front() ? ": " : " + ", effect.name);
  fmt::print("\nerror on held-out data: {:.4g} {} before, {:.4g} {} after (noise floor {:.3g} {})\n",
             e.base.errors.rmse_validation, unit, e.after.errors.rmse_validation, unit, e.floor.rmse, unit);
  for (const auto& effect : e.effects) {
    for (std::size_t i = 0; i < effect.keys.size(); ++i) {
      if (effect.half_width95[i] > 0)
        fmt::print("  {} = {:.4g} +- {:.2g}\n", effect.keys[i], effect.values[i], effect.half_width95[i]);
    }
  }
  for (const auto& rival : e.rivals) {
    if (rival.indistinguishable)
      fmt::print("this recording cannot tell it from {}; {} would\n", rival.name, rival.separate_by);
  }
  if (e.rest) fmt::print("unexplained: {}\n", e.rest->description);
  if (outcome.margins.before && outcome.margins.after && outcome.margins.critical_stiffness_before > 0 &&
      std::isfinite(outcome.margins.critical_stiffness_before)) {
    fmt::print("stiffest stable wall: {:.4g} N/m before, {:.4g} N/m after\n", outcome.margins.critical_stiffness_before,
               outcome.margins.critical_stiffness_after);
  }
  if (!given.out.empty()) fmt::print("{}/report.html\n", given.out);
}

}  // namespace

void add_explain_command(CLI::App& program) {
  auto options = std::make_shared<Options>();
  auto* command =
      program.add_subcommand("explain", "Trace a recording's residual to the effect its model lacks, and add it");
  command->add_option("recording", options->recording, "CSV or .mat")->required();
  command->add_option("--validate", options->validate,
                      "A second recording to judge on (default: the last 40 % of the first)");
  command->add_option("--base", options->base, "Base model: arm5 or msd")
      ->check(CLI::IsMember({"arm5", "msd"}))
      ->capture_default_str();
  command->add_option("--driven-by", options->driven_by, "What is given: force or position")
      ->check(CLI::IsMember({"force", "position"}))
      ->capture_default_str();
  command->add_option("--axis", options->axis, "Axis the recording belongs to, for the model file")
      ->capture_default_str();
  command->add_option("--max-effects", options->max_effects, "At most so many effects")
      ->check(CLI::Range(0, 5))
      ->capture_default_str();
  command->add_option("--time", options->columns.time, "Time column, name or number");
  command->add_option("--force", options->columns.force, "Force column, name or number");
  command->add_option("--position", options->columns.position, "Position column, name or number");
  command->add_option("--rate", options->columns.rate_Hz, "Samples a second, where there is no time column");
  command->add_option("--out", options->out, "Directory for model.toml, explain.json and report.html");
  command->add_option("--json", options->json, "File for the machine form, - for standard output");
  command->footer("Example: handloop explain trial_001.csv --out out/explain");
  command->callback([options] { run(*options); });
}

}  // namespace handloop::cli
