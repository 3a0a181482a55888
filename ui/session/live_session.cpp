#include "ui/session/live_session.h"

#include <algorithm>
#include <chrono>

#include "device/log_file.h"
#include "device/open_device.h"
#include "io/output.h"
#include "io/scenario_file.h"
#include "models/errors.h"

namespace handloop::ui {
namespace {

constexpr double kEvidence_s = 2.2;
constexpr double kAfterFault_s = 0.2;

control::VirtualWallGains gains_of(const models::Scenario& scenario) {
  return {scenario.loop.stiffness_N_per_m, scenario.loop.damping_Ns_per_m, scenario.loop.cutoff_Hz};
}

}  // namespace

LiveSession::LiveSession() = default;

LiveSession::~LiveSession() {
  loop_.reset();
  ending_.clear();
}

bool LiveSession::only_gains_changed(const models::Scenario& to) const {
  auto alike = to;
  alike.loop.stiffness_N_per_m = scenario_.loop.stiffness_N_per_m;
  alike.loop.damping_Ns_per_m = scenario_.loop.damping_Ns_per_m;
  alike.loop.cutoff_Hz = scenario_.loop.cutoff_Hz;
  return io::to_toml(alike) == io::to_toml(scenario_);
}

void LiveSession::follow(const models::Scenario& scenario, std::uint64_t revision) {
  std::erase_if(ending_,
                [](const auto& end) { return end.wait_for(std::chrono::seconds(0)) == std::future_status::ready; });
  if (revision != revision_) {
    const bool first = revision_ == 0;
    const bool plant_changed = first || !only_gains_changed(scenario);
    revision_ = revision;
    scenario_ = scenario;
    if (loop_) loop_->set_gains(gains_of(scenario_));
    if (plant_changed) {
      remake_ = true;
      if (simulated() && !faulted()) make();
    }
  }
  if (auto made = making_.take()) take_over(std::move(*made));
  if (auto error = making_.take_error(); !error.empty()) {
    problem_ = error;
    arming_.disarm();
  }
  drain();
}

void LiveSession::make() {
  remake_ = false;
  problem_.clear();
  making_.request([address = address_, scenario = scenario_](JobContext&) {
    return std::optional(std::make_shared<device::LiveLoop>(
        device::open_device(address, {.scenario = scenario, .realtime = true}), scenario));
  });
}

void LiveSession::take_over(std::shared_ptr<device::LiveLoop> loop) {
  retire();
  loop_ = std::move(loop);
  sim_ = dynamic_cast<device::SimDevice*>(&loop_->device());
  status_ = {};
  evidence_.clear();
  home_tip_m_ = loop_->home_tip_m();
  traces_.begin(loop_->device().description(), home_tip_m_);
  black_box_ = std::make_unique<device::BlackBox>(kEvidence_s, traces_.sample_time_s());
  loop_->set_speed(paused_ ? 0.0 : speed_);
  loop_->set_gains(gains_of(scenario_));
  try {
    loop_->start();
  } catch (const std::exception& error) {
    problem_ = error.what();
    arming_.disarm();
    loop_.reset();
    sim_ = nullptr;
  }
}

void LiveSession::retire() {
  if (!loop_) return;
  drain();
  if (sim_ != nullptr) {
    ending_.push_back(std::async(std::launch::async, [loop = std::move(loop_)]() mutable { loop.reset(); }));
  }
  loop_.reset();
  sim_ = nullptr;
}

void LiveSession::drain() {
  if (!loop_) return;
  status_ = loop_->status();
  device::StepRecord record;
  while (loop_->pop(record)) {
    traces_.add(record);
    last_ = record;
    has_record_ = true;
    if (record.fault != device::Fault::none && fault_step_ == 0) fault_step_ = record.step + 1;
    if (record.fault == device::Fault::none) fault_step_ = 0;
    const double after_s =
        fault_step_ == 0 ? 0.0 : static_cast<double>(record.step + 1 - fault_step_) * traces_.sample_time_s();
    if (after_s <= kAfterFault_s) black_box_->add(record);
    if (after_s > kAfterFault_s && evidence_.empty()) {
      for (std::size_t i = 0; i < black_box_->size(); ++i) evidence_.push_back((*black_box_)[i]);
    }
  }
}

void LiveSession::use_device(const std::string& address) {
  making_.cancel();
  retire();
  arming_.disarm();
  status_ = {};
  evidence_.clear();
  problem_.clear();
  address_ = address;
  remake_ = true;
  if (simulated()) make();
}

void LiveSession::set_paused(bool paused) {
  paused_ = paused;
  if (loop_) loop_->set_speed(paused_ ? 0.0 : speed_);
}

void LiveSession::single_step() {
  set_paused(true);
  if (loop_) loop_->single_step();
}

void LiveSession::set_speed(double speed) {
  speed_ = std::clamp(speed, 0.01, 1.0);
  if (loop_ && !paused_) loop_->set_speed(speed_);
}

void LiveSession::reset() {
  if (simulated()) {
    status_ = {};
    make();
  } else {
    disarm();
  }
}

void LiveSession::stop() {
  arming_.close_cover();
  if (loop_) loop_->trip();
}

void LiveSession::start_armed() {
  if (!simulated() && arming_.armed()) make();
}

void LiveSession::disarm() {
  making_.cancel();
  arming_.disarm();
  retire();
  status_ = {};
  remake_ = true;
}

void LiveSession::pull(const sim::Pull& pull) {
  if (sim_ != nullptr) sim_->pull(pull);
}

void LiveSession::write_evidence(const std::filesystem::path& path) const {
  const device::LogFormat format{scenario_.wall.axis, home_tip_m_};
  std::string text(device::log_header());
  text += '\n';
  std::string row(device::kMaxRow, '\0');
  for (const auto& record : evidence_) text.append(row.data(), device::format_row(record, format, row.data()));
  io::write_file_atomically(path, text);
}

}  // namespace handloop::ui
