#include <fmt/format.h>

#include <memory>

#include "cli/commands.h"
#include "cli/progress_bar.h"
#include "io/model_file.h"
#include "io/scenario_file.h"
#include "models/errors.h"
#include "studies/experiment.h"

namespace handloop::cli {
namespace {

struct Options {
  std::string axis = "all", grips = "1,2,3", scenario, arm, out, stimulus = "noise", percentiles = "ecdf", sensed_at;
  std::size_t subjects = 15;
  std::uint64_t seed = 1;
  double rms_N = 0.0, duration_s = 60.0, wander_m = -1.0;
  bool ideal = false;
  unsigned jobs = 0;
};

std::vector<int> parse_grips(const std::string& text) {
  std::vector<int> grips;
  for (std::size_t at = 0; at <= text.size();) {
    const auto end = std::min(text.find(',', at), text.size());
    const auto word = text.substr(at, end - at);
    if (word != "1" && word != "2" && word != "3") {
      throw InputError(
          fmt::format("--grips {}: '{}' is not a grip force that was measured; give some of 1,2,3 (N)", text, word));
    }
    const int grip = word[0] - '0';
    for (const int earlier : grips) {
      if (earlier == grip) throw InputError(fmt::format("--grips {}: {} stands there twice", text, word));
    }
    grips.push_back(grip);
    at = end + 1;
  }
  return grips;
}

studies::ExperimentRequest to_request(const Options& options) {
  studies::ExperimentRequest request;
  if (options.axis != "all") request.axes = {models::parse_axis(options.axis)};
  request.subjects = options.subjects;
  request.grips_N = parse_grips(options.grips);
  request.seed = options.seed;
  request.stimulus = studies::parse_stimulus_kind(options.stimulus);
  request.stimulus_rms_N = options.rms_N;
  request.duration_s = options.duration_s;
  request.percentiles = models::parse_percentile_reading(options.percentiles);
  request.jobs = options.jobs;
  if (!options.scenario.empty()) request.rig = io::read_scenario(options.scenario);
  if (options.ideal) request.rig.electronics.ideal = true;
  if (options.wander_m >= 0) request.rig.arm.wander_rms_m = options.wander_m;
  if (options.sensed_at == "flange") {
    request.rig.arm.force_sensed_at = models::ForceSensedAt::flange;
  } else if (options.sensed_at == "grip") {
    request.rig.arm.force_sensed_at = models::ForceSensedAt::grip;
  } else if (!options.sensed_at.empty()) {
    throw InputError(fmt::format("--force-sensed-at {}: give grip or flange", options.sensed_at));
  }
  if (!options.arm.empty()) {
    request.arm = io::read_model(options.arm);
    if (options.axis != "all" && request.arm->axis != request.axes.front()) {
      throw InputError(fmt::format("--axis {}: {} is an arm of axis {}; leave --axis out or change the file",
                                   options.axis, options.arm, models::axis_name(request.arm->axis)));
    }
  }
  return request;
}

void run(const Options& options) {
  const auto summary = studies::run_experiment(to_request(options), options.out, progress_bar("recording"));
  fmt::print(
      "{} trial{} recorded in {}: {:.0f} s of simulated time in {:.1f} s ({:.0f} times real time), {} samples "
      "clipped\n",
      summary.trials, summary.trials == 1 ? "" : "s", options.out, summary.recorded_s, summary.wall_time_s,
      summary.recorded_s / summary.wall_time_s, summary.clipped_samples);
}

}  // namespace

void add_experiment_command(CLI::App& program) {
  auto options = std::make_shared<Options>();
  auto* command =
      program.add_subcommand("experiment", "Record the arm paper's protocol on the simulated Phantom and arms");
  command->add_option("--axis", options->axis, "x, y, z or all")->capture_default_str();
  command->add_option("--subjects", options->subjects, "how many people")
      ->capture_default_str()
      ->check(CLI::Range(1, 10000));
  command->add_option("--grips", options->grips, "grip forces in N, some of 1,2,3")->capture_default_str();
  command->add_option("--seed", options->seed, "the same seed gives the same recordings")->capture_default_str();
  command->add_option("--out", options->out, "directory for trial_*.csv, index.csv and report.html")->required();
  command->add_option("--scenario", options->scenario,
                      "device, electronics, wander and sensing of the rig; its arms and wall do not matter");
  command->add_option("--arm", options->arm, "record this one arm (model file), its effects included");
  command->add_flag("--ideal", options->ideal, "no sensor noise, no quantisation, no saturation");
  command->add_option("--stimulus", options->stimulus, "noise (the paper's) or multisine (odd random-phase grid)")
      ->capture_default_str();
  command->add_option("--rms", options->rms_N, "of the stimulus, N; 0: a third of the force cap")
      ->capture_default_str();
  command->add_option("--duration", options->duration_s, "of a trial, s")->capture_default_str();
  command->add_option("--wander", options->wander_m, "rms of slow voluntary motion, m (default 0)");
  command->add_option("--force-sensed-at", options->sensed_at,
                      "grip (what the arm receives; default) or flange (as in the rig)");
  command->add_option("--percentiles", options->percentiles, "reading of Table III: ecdf or central")
      ->capture_default_str();
  command->add_option("--jobs", options->jobs, "trials at a time; 0: one a core")->capture_default_str();
  command->footer("Example: handloop experiment --axis z --subjects 15 --grips 1,2,3 --seed 1 --out out/experiment");
  command->callback([options] { run(*options); });
}

}  // namespace handloop::cli
