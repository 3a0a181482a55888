#include <fmt/format.h>

#include <cmath>
#include <memory>

#include "cli/commands.h"
#include "cli/progress_bar.h"
#include "cli/scenario_argument.h"
#include "sim/scene_file.h"
#include "studies/demo.h"

namespace handloop::cli {
namespace {

struct Options : studies::DemoOptions {
  std::string scenario = (sim::scenes_directory() / "phantom_wall.toml").string();
  std::string out = "out/demo";
};

void print(const studies::Demo& demo, const std::string& out) {
  const auto& s = demo.scenario;
  fmt::print("{}\nwall {} N/m, {} N s/m on axis {}, {} sample(s) of delay, {} kHz\n\n", s.description,
             s.loop.stiffness_N_per_m, s.loop.damping_Ns_per_m, axis_name(s.wall.axis), s.loop.delay_samples,
             1e-3 / s.loop.sample_time_s);
  fmt::print("axis   nominal arm                                  {} sampled arms\n", demo.options.arms);
  fmt::print("       gain margin  phase margin  stiffest wall    stable (95 %)              stiffest wall for 95 %\n");
  for (const auto& a : demo.axes) {
    const auto& m = a.nominal;
    fmt::print("{:<6} {:>11} {:>13} {:>10.0f} N/m    {:<27}{:.0f} N/m\n", axis_name(a.axis),
               m.stable ? fmt::format("{:.2f}", m.gain_up) : "unstable",
               m.stable ? fmt::format("{:.1f} deg", std::abs(m.phase_deg)) : "-", a.critical_stiffness_N_per_m,
               fmt::format("{:.1f} % ({:.1f} to {:.1f})", 100 * a.population.stable.estimate,
                           100 * a.population.stable.low95, 100 * a.population.stable.high95),
               a.permitted_stiffness_N_per_m);
  }
  fmt::print("\nclosed loop: {:g} s simulated at {:.0f} thousand steps/s, {}\n", demo.wall.t_s.back(),
             demo.wall.steps_per_s / 1e3, demo.wall.fault.empty() ? "no fault" : demo.wall.fault);
  fmt::print("20 % beyond the limit ({:.0f} N/m): {}\n\n", demo.beyond_stiffness_N_per_m,
             demo.beyond.fault.empty()
                 ? "it rings, within the safety limits"
                 : fmt::format("stopped after {:.2f} s: {}", demo.beyond.fault_at_s, demo.beyond.fault));
  fmt::print("{}/report.html\n", out);
}

}  // namespace

void add_demo_command(CLI::App& program) {
  auto* command = program.add_subcommand("demo", "The main job on one page: closed loop, margins, arms");
  const auto options = std::make_shared<Options>();
  command->add_option("scenario", options->scenario, "scenario file; the virtual wall where none is given");
  command->add_option("--arms", options->arms, "sampled arms")->check(CLI::Range(20, 1'000'000))->capture_default_str();
  command->add_option("--seed", options->seed, "of the sampled arms")->capture_default_str();
  command->add_option("--out", options->out, "directory for report.html and its data")->capture_default_str();
  command->footer("Example: handloop demo --out out/demo");
  command->callback([options] {
    const auto demo = studies::run_demo(read_scenario_argument(options->scenario), *options, progress_bar("demo"));
    studies::write_demo(demo, options->out);
    print(demo, options->out);
  });
}

}  // namespace handloop::cli
