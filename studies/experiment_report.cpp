#include "studies/experiment_report.h"

#include <fmt/format.h>

#include <algorithm>

#include "io/report.h"
#include "studies/arm_sampling.h"

namespace handloop::studies {
namespace {

constexpr double kExcerptFrom_s = 20.0;
constexpr double kExcerptLength_s = 5.0;

std::string axis_in_words(models::Axis axis) {
  switch (axis) {
    case models::Axis::x:
      return "X, left and right";
    case models::Axis::y:
      return "Y, up and down";
    default:
      return "Z, forward and backward";
  }
}

std::string duration_in_words(double seconds) {
  return seconds < 120 ? fmt::format("{:.3g} s", seconds) : fmt::format("{:.0f} min", seconds / 60);
}

void add_excerpt(io::Report& report, const Trial& trial, const TrialOutcome& outcome) {
  const auto& seconds = outcome.seconds;
  std::vector<double> position_mm(seconds.position_m.size());
  std::ranges::transform(seconds.position_m, position_mm.begin(), [](double x) { return 1e3 * x; });
  io::Plot force{
      .title = fmt::format("Axis {}: force", axis_in_words(trial.axis)), .x_label = "time, s", .y_label = "force, N"};
  force.series.push_back({.x = seconds.time_s, .y = seconds.force_N, .colour = io::Colour::blue, .width = 1.2});
  force.width_px = 560;
  force.height_px = 280;
  io::Plot position{.title = "position", .x_label = "time, s", .y_label = "position, mm"};
  position.series.push_back({.x = seconds.time_s, .y = position_mm, .colour = io::Colour::orange, .width = 1.2});
  position.width_px = 560;
  position.height_px = 280;
  report.plots({force, position},
               fmt::format("Trial {}, subject {}, grip force {} N.", trial.number, trial.subject, trial.grip_N));
}

}  // namespace

TrialExcerpt excerpt(const TrialRecord& record) {
  TrialExcerpt part;
  const auto size = record.force_N.size();
  const auto length = std::min(size, static_cast<std::size_t>(kExcerptLength_s / record.sample_time_s));
  const auto from = std::min(static_cast<std::size_t>(kExcerptFrom_s / record.sample_time_s), size - length);
  for (std::size_t i = from; i < from + length; i += 2) {
    part.time_s.push_back(static_cast<double>(i) * record.sample_time_s);
    part.force_N.push_back(record.force_N[i]);
    part.position_m.push_back(record.position_m[i]);
  }
  return part;
}

std::string experiment_report(const ExperimentRequest& request, const std::vector<Trial>& trials,
                              const std::vector<TrialOutcome>& outcomes) {
  io::Report report("Experiment",
                    fmt::format("{} trial{} of {:g} s on the simulated Phantom Premium 1.5, seed {}", trials.size(),
                                trials.size() == 1 ? "" : "s", request.duration_s, request.seed));
  std::size_t clipped = 0;
  for (const auto& outcome : outcomes) clipped += outcome.clipped_samples;
  const double samples = request.duration_s / request.rig.loop.sample_time_s * static_cast<double>(trials.size());
  report.figures(
      {{.label = "trials", .value = std::to_string(trials.size())},
       {.label = "recorded", .value = duration_in_words(request.duration_s * static_cast<double>(trials.size()))},
       {.label = "clipped samples", .value = fmt::format("{:.3f} %", 100 * static_cast<double>(clipped) / samples)}});

  report.section("Protocol");
  report.list(
      {request.stimulus == StimulusKind::noise ? "Stimulus: Gaussian noise through a 13th-order Butterworth low-pass "
                                                 "at 30 Hz, along one axis at a time; the other "
                                                 "axes are free, gravity is compensated."
                                               : "Stimulus: random-phase multisine to 30 Hz on odd harmonics of 0.1 "
                                                 "Hz, one of four in a row left out at random; the "
                                                 "other axes are free, gravity is compensated.",
       "Its rms is a third of the force cap unless given; the cap is 5 N or what the 3 A current limit leaves along "
       "the axis at "
       "the pose. What exceeds it is clipped and counted. Where the motion left the device's limits of speed or "
       "workspace, the trial was "
       "repeated at half the force (column rms asked).",
       fmt::format("Sampled at {:g} kHz; force sensed at the {}; {}.", 1e-3 / request.rig.loop.sample_time_s,
                   request.rig.arm.force_sensed_at == models::ForceSensedAt::grip ? "grip"
                                                                                  : "device's flange, stylus beyond it",
                   request.rig.electronics.ideal ? "ideal sensors and converters"
                                                 : "sensor noise and quantisation as in the rig"),
       "Columns: `time_s`, `force_N` (sensor), `position_m` (encoders), `grip_force_N`, `command_N` (asked of the "
       "motors, held "
       "until the next sample)."});
  if (!request.arm) {
    report.callout(io::Report::Tone::assumption,
                   population_assumptions(models::ArmPopulation(models::Axis::x, request.percentiles)));
    report.callout(io::Report::Tone::assumption,
                   "Each subject, grip force and axis has an arm of its own, drawn independently from Table III: what "
                   "the grips of "
                   "one person have in common was not published.");
  }

  report.section("Five seconds of each axis");
  for (const auto axis : models::kAxes) {
    const auto found = std::ranges::find_if(trials, [axis](const Trial& trial) { return trial.axis == axis; });
    if (found != trials.end()) add_excerpt(report, *found, outcomes[static_cast<std::size_t>(found - trials.begin())]);
  }

  report.section("Trials");
  io::Table table{.columns = {"trial", "subject", "grip, N", "axis", "M, kg", "k1, N/m", "k2, N/m", "b1, N s/m",
                              "b2, N s/m", "cap, N", "rms asked, N", "force rms, N", "position rms, mm", "clipped"}};
  for (std::size_t i = 0; i < trials.size(); ++i) {
    const auto& trial = trials[i];
    const auto& arm = trial.arms[static_cast<std::size_t>(trial.axis)];
    table.rows.push_back({std::to_string(trial.number), std::to_string(trial.subject), std::to_string(trial.grip_N),
                          std::string(models::axis_name(trial.axis)), io::pretty(arm.mass_kg),
                          io::pretty(arm.k1_N_per_m), io::pretty(arm.k2_N_per_m), io::pretty(arm.b1_Ns_per_m),
                          io::pretty(arm.b2_Ns_per_m), io::pretty(outcomes[i].cap_N, 3),
                          io::pretty(outcomes[i].stimulus_rms_N, 3), io::pretty(outcomes[i].force_rms_N, 3),
                          io::pretty(1e3 * outcomes[i].position_rms_m, 3),
                          std::to_string(outcomes[i].clipped_samples)});
  }
  report.table(table);
  return report.to_html();
}

}  // namespace handloop::studies
