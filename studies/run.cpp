#include "studies/run.h"

#include <fmt/format.h>

#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <memory>

#include "control/controllers/force_amplifier.h"
#include "control/controllers/phantom_mechanism.h"
#include "control/controllers/seven_bar_mechanism.h"
#include "control/controllers/virtual_wall.h"
#include "device/fault_injection.h"
#include "device/live_loop.h"
#include "device/open_device.h"
#include "device/realtime.h"
#include "device/replay_device.h"
#include "device/wire/wire_device.h"
#include "io/output.h"
#include "models/errors.h"
#include "studies/run_report.h"
#include "studies/run_stability.h"
#include "studies/seven_bar_report.h"

namespace handloop::studies {
namespace {

namespace fs = std::filesystem;
using device::Fault;
constexpr double kEvidence_s = 2.0;
constexpr std::uint64_t kLongestTrace = 1'000'000;

/// Passes records on and keeps what judge and pictures need; the memory for it is reserved before.
class Observer final : public device::Recorder {
 public:
  Observer(device::Recorder& inner, StabilityJudge& judge, RunTrace& trace, int row, double home_m,
           SevenBarRunTrace* seven_bar)
      : inner_(inner), judge_(judge), trace_(trace), row_(row), home_m_(home_m), seven_bar_(seven_bar) {}
  bool take(const device::StepRecord& record) noexcept override {
    judge_.add(seven_bar_ != nullptr ? seven_bar_->add(record) : record);
    trace_.add(record, row_, home_m_);
    return inner_.take(record);
  }
  bool finish() noexcept override { return inner_.finish(); }

 private:
  device::Recorder& inner_;
  StabilityJudge& judge_;
  RunTrace& trace_;
  int row_;
  double home_m_;
  SevenBarRunTrace* seven_bar_;
};

std::unique_ptr<control::Mechanism> mechanism_of(const models::Scenario& scenario) {
  if (scenario.device.model == models::DeviceModel::seven_bar) {
    return std::make_unique<control::SevenBarMechanism>(control::seven_bar_of(scenario));
  }
  return control::make_mechanism(scenario.device);
}

std::unique_ptr<control::Controller> controller_of(const models::Scenario& scenario, const Eigen::Vector3d& home_m) {
  if (scenario.device.model == models::DeviceModel::seven_bar) {
    return std::make_unique<control::ForceAmplifier>(control::make_force_amplifier(scenario));
  }
  return std::make_unique<control::VirtualWall>(control::make_virtual_wall(scenario, home_m));
}

void reserve(RunTrace& trace, std::uint64_t samples) {
  trace.every = samples / kLongestTrace + 1;
  for (auto* signal :
       {&trace.time_s, &trace.position_m, &trace.wanted_N, &trace.written_N, &trace.sensed_N, &trace.energy_J}) {
    signal->reserve(samples / trace.every + 1);
  }
}

void write_evidence(const fs::path& path, const device::BlackBox& box, const device::LogFormat& format) {
  device::LogFile file(path, format, 1000);
  for (std::size_t i = 0; i < box.size(); ++i) file.add(box[i]);
  file.close();
}

/// Where the disk is full, at least what was logged gets its place, without asking for more room than a rename needs.
void rescue_log(const fs::path& staged, const fs::path& out) {
  std::error_code error;
  fs::create_directories(out, error);
  fs::rename(staged, out / "log.csv", error);
}

/// Logs of runs to the same place that were killed: they lie hidden beside it.
std::vector<std::string> logs_of_killed_runs(const fs::path& out) {
  std::vector<std::string> notes;
  const fs::path target = fs::absolute(out).lexically_normal();
  const std::string begin = "." + (target.has_filename() ? target : target.parent_path()).filename().string() + ".";
  std::error_code ignored;
  for (const auto& entry :
       fs::directory_iterator((target.has_filename() ? target : target.parent_path()).parent_path(), ignored)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with(begin) || !name.ends_with(".part") || !fs::exists(entry.path() / "log.csv", ignored))
      continue;
    const int process = std::atoi(name.c_str() + begin.size());
    if (process > 0 && ::kill(process, 0) != 0 && errno == ESRCH) {
      notes.push_back("a run that was killed left its log in " + (entry.path() / "log.csv").string());
    }
  }
  return notes;
}

std::vector<std::string> notes_about(const device::Device& device) {
  std::vector<std::string> notes;
  if (const auto* replay = dynamic_cast<const device::ReplayDevice*>(&device); replay && replay->has_commands()) {
    notes.push_back(fmt::format("{} of {} commands differ from those in the recording", replay->different_commands(),
                                replay->samples()));
  }
  if (const auto* wire = dynamic_cast<const device::wire::WireDevice*>(&device)) {
    const auto& c = wire->counters();
    notes.push_back(
        fmt::format("wire: {} packets sent, {} received; {} lost, {} doubled, {} reordered, {} refused, {} sent again",
                    c.sent, c.received, c.lost, c.doubled, c.reordered, c.refused(), c.sent_again));
  }
  return notes;
}

std::uint64_t step_count(const device::Device& device, double duration_s) {
  const double steps = std::round(duration_s / device.description().sample_time_s);
  if (!(steps >= 1.0) || steps > 1e10) {
    throw InputError(fmt::format("--duration {} s is not possible; give at least one sample time ({} s)", duration_s,
                                 device.description().sample_time_s));
  }
  auto count = static_cast<std::uint64_t>(steps);
  if (const auto* replay = dynamic_cast<const device::ReplayDevice*>(&device)) {
    count = std::min(count, replay->samples());
  }
  return count;
}

}  // namespace

std::string describe(const device::FaultEvent& fault) {
  const auto& info = device::fault_info(fault.fault);
  std::string text = fmt::format("fault {}: {}", info.name, info.meaning);
  if (!info.unit.empty())
    text += fmt::format(" ({:.4g} {} where {:.4g} is allowed)", fault.value, info.unit, fault.limit);
  return text + fmt::format(" at {:.3f} s", static_cast<double>(fault.time_ns) * 1e-9);
}

RunOutcome run(const RunOptions& options) {
  const models::Scenario& scenario = options.scenario;
  const bool linkage = scenario.device.model == models::DeviceModel::seven_bar;
  const auto mechanism = mechanism_of(scenario);
  const Eigen::Vector3d home = mechanism->at(device::pose_rad(scenario)).tip_m;
  const auto controller = controller_of(scenario, home);

  const auto bare = device::open_device(options.device, {scenario, options.realtime, options.key});
  std::unique_ptr<device::FaultyDevice> faulty;
  if (!options.inject.empty()) {
    const auto injection = device::parse_injection(options.inject);
    faulty = std::make_unique<device::FaultyDevice>(*bare, injection.name, injection.from_sample);
  }
  device::Device& device = faulty ? static_cast<device::Device&>(*faulty) : *bare;
  device::Loop loop(device::loop_config(scenario, home), device.description(), *mechanism, *controller);

  device::SessionOptions session;
  session.steps = step_count(*bare, scenario.run.duration_s);
  session.paced = options.realtime;
  session.stop = options.stop;

  auto leftovers = logs_of_killed_runs(options.out);
  io::OutputDirectory directory(options.out);
  const device::LogFormat format{scenario.wall.axis, home, linkage};
  const int row = models::device_row(scenario.wall.axis);
  RunOutcome outcome;
  RunTrace trace;
  SevenBarRunTrace linkage_trace(device.description().sample_time_s, home);
  StabilityJudge judge(session.steps, device.description().sample_time_s, scenario.hand.disturbance_N > 0.0);
  device::BlackBox black_box(kEvidence_s, device.description().sample_time_s);
  {
    device::LogFile log(directory / "log.csv", format);
    reserve(trace, session.steps);
    std::unique_ptr<device::Recorder> writer;
    const bool paced = options.realtime || !device.lock_step();
    if (paced) {
      writer = std::make_unique<device::ThreadedRecorder>(log);
      auto grant = device::request_realtime();
      outcome.realtime_refused = std::move(grant.refused);
    } else {
      writer = std::make_unique<device::DirectRecorder>(log);
    }
    if (linkage) linkage_trace.reserve(session.steps);
    Observer observer(*writer, judge, trace, row, home[row], linkage ? &linkage_trace : nullptr);
    device::MonotonicClock clock;
    outcome.session = run_session(device, loop, observer, black_box, clock, session);
    if (paced) device::release_realtime();
    if (!writer->finish() && !log.failed()) {
      outcome.notes.push_back("the disk was too slow: samples are missing in log.csv");
    }
    if (log.failed()) outcome.log_error = log.error();
  }

  outcome.device = bare->name();
  outcome.why_unstable = judge.verdict();
  outcome.stable = outcome.why_unstable.empty();
  outcome.duration_s = static_cast<double>(outcome.session.steps) * device.description().sample_time_s;
  outcome.sim_steps_per_s = static_cast<double>(outcome.session.steps) / std::max(outcome.session.wall_time_s, 1e-9);
  outcome.real_time_factor = outcome.duration_s / std::max(outcome.session.wall_time_s, 1e-9);
  const auto about = notes_about(*bare);
  outcome.notes.insert(outcome.notes.begin(), about.begin(), about.end());
  outcome.notes.insert(outcome.notes.end(), leftovers.begin(), leftovers.end());
  if (faulty) outcome.notes.push_back("broken on purpose: " + options.inject);
  if (!outcome.log_error.empty()) {
    rescue_log(directory / "log.csv", directory.target());
    return outcome;
  }
  if (outcome.session.fault.fault != Fault::none) write_evidence(directory / "fault.csv", black_box, format);
  io::write_file_atomically(directory / "summary.json", run_summary_json(options, outcome));
  if (linkage) {
    write_seven_bar_report(directory / "report.html", options, outcome, linkage_trace);
  } else {
    write_run_report(directory / "report.html", options, outcome, trace);
  }
  directory.commit();
  return outcome;
}

}  // namespace handloop::studies
