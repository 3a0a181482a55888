#include "studies/loop_trace.h"

#include <fmt/format.h>

#include <chrono>
#include <cmath>

#include "control/controllers/phantom_mechanism.h"
#include "control/controllers/virtual_wall.h"
#include "device/live_loop.h"
#include "device/recorder.h"
#include "device/session.h"
#include "device/sim_device.h"

namespace handloop::studies {
namespace {

class TraceRecorder final : public device::Recorder {
 public:
  TraceRecorder(LoopTrace* trace, const models::Scenario& scenario, const Eigen::Vector3d& home_m, std::size_t steps)
      : trace_(trace), row_(device_row(scenario.wall.axis)), plane_m_(home_m[row_] + scenario.wall.position_m) {
    for (auto* column : {&trace_->t_s, &trace_->position_m, &trace_->wall_force_N, &trace_->hand_force_N}) {
      column->reserve(steps);
    }
  }

  bool take(const device::StepRecord& record) noexcept override {
    trace_->t_s.push_back(1e-9 * static_cast<double>(record.reading.time_ns));
    trace_->position_m.push_back(record.tip_m[row_] - plane_m_);
    trace_->wall_force_N.push_back(record.written_force_N[row_]);
    trace_->hand_force_N.push_back(record.sensed_force_N[row_]);
    return true;
  }
  bool finish() noexcept override { return true; }

 private:
  LoopTrace* trace_;
  int row_;
  double plane_m_;
};

std::string in_words(const device::FaultEvent& event) {
  const auto& info = device::fault_info(event.fault);
  if (info.unit.empty()) return std::string(info.meaning);
  return fmt::format("{} ({:.3g} {}, allowed {:.3g})", info.meaning, event.value, info.unit, event.limit);
}

}  // namespace

LoopTrace trace_loop(const models::Scenario& scenario) {
  device::SimDevice device(scenario);
  const auto mechanism = control::make_mechanism(scenario.device);
  const Eigen::Vector3d pose(scenario.device.pose_rad[0], scenario.device.pose_rad[1], scenario.device.pose_rad[2]);
  const Eigen::Vector3d home_m = mechanism->at(pose).tip_m;
  auto wall = control::make_virtual_wall(scenario, home_m);
  device::Loop loop(device::loop_config(scenario, home_m), device.description(), *mechanism, wall);

  device::SessionOptions options;
  options.steps = static_cast<std::uint64_t>(std::llround(scenario.run.duration_s / scenario.loop.sample_time_s));
  LoopTrace trace;
  TraceRecorder recorder(&trace, scenario, home_m, options.steps);
  device::BlackBox black_box(0.1, scenario.loop.sample_time_s);
  device::MonotonicClock clock;
  const auto result = run_session(device, loop, recorder, black_box, clock, options);
  if (result.fault.fault != device::Fault::none) {
    trace.fault = in_words(result.fault);
    trace.fault_at_s = 1e-9 * static_cast<double>(result.fault.time_ns);
  }
  trace.steps_per_s = static_cast<double>(result.steps) / result.wall_time_s;
  return trace;
}

}  // namespace handloop::studies
