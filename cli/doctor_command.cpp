#include <fmt/format.h>

#include <memory>

#include "cli/commands.h"
#include "cli/progress_bar.h"
#include "io/output.h"
#include "models/errors.h"
#include "studies/doctor.h"

namespace handloop::cli {
namespace {

struct Options {
  double seconds = 10.0;
  std::string json;
};

std::string yes_no(bool value) {
  return value ? "yes" : "no";
}

void print(const studies::Diagnosis& d) {
  const auto line = [](std::string_view name, const std::string& value) { fmt::print("  {:<22}{}\n", name, value); };
  const auto times = [](const device::LatencyHistogram& h) {
    return fmt::format("p50 {:.1f}, p99 {:.1f}, p99.9 {:.1f}, max {:.1f} us", h.percentile_us(0.5),
                       h.percentile_us(0.99), h.percentile_us(0.999), h.max_us());
  };
  fmt::print("grade {}: {}\n", d.grade, studies::grade_text(d.grade));
  for (const auto& reason : d.reasons) fmt::print("  - {}\n", reason);
  fmt::print("\n");
  line("wake-ups at 1 kHz", times(d.wake) + fmt::format(" late, over {:g} s", d.seconds));
  line("deadlines missed", std::to_string(d.timing.missed));
  line("one pass of the loop", times(d.loop));
  line("simulation", fmt::format("{:.0f} samples a second", d.sim_steps_per_s));
  line("SCHED_FIFO", yes_no(d.realtime.fifo));
  line("locked memory", yes_no(d.realtime.memory_locked));
  line("kernel", d.kernel + (d.realtime_kernel ? " (real-time)" : ""));
  line("processors", std::to_string(d.processors) + (d.governor.empty() ? "" : ", governor " + d.governor));
  line("stolen time", fmt::format("{:.2f} %", d.steal_percent));
  line("OpenGL", d.opengl.empty() ? "none: " + d.opengl_problem : d.opengl);
  line("gnuplot", d.gnuplot.empty() ? "missing: reports cannot be drawn" : d.gnuplot);
  if (d.boards.empty()) line("Comedi", "no board");
  for (const auto& board : d.boards) {
    line(board.path, board.problem.empty()
                         ? fmt::format("{}: {} counters, {} analog inputs, {} analog outputs", board.name,
                                       board.counters, board.analog_inputs, board.analog_outputs)
                         : board.problem);
  }
}

void examine(const Options& options) {
  if (!(options.seconds >= 0.1 && options.seconds <= 86400.0)) {
    throw InputError("doctor: --seconds must be from 0.1 to 86400");
  }
  const auto diagnosis = studies::diagnose(options.seconds, progress_bar("measuring wake-ups"));
  if (options.json != "-") print(diagnosis);
  if (!options.json.empty()) io::write_file_atomically(options.json, studies::diagnosis_json(diagnosis));
}

}  // namespace

void add_doctor_command(CLI::App& program) {
  auto options = std::make_shared<Options>();
  auto* command = program.add_subcommand("doctor", "What this machine can do: timing, privileges, OpenGL, boards");
  command->add_option("--seconds", options->seconds, "How long to measure")->capture_default_str();
  command->add_option("--json", options->json, "Machine form into this file (-: standard output)");
  command->footer("Example: handloop doctor --seconds 60 --json doctor.json");
  command->callback([options] { examine(*options); });
}

}  // namespace handloop::cli
