#include "ui/views/device_view.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "ui/widgets/fields.h"
#include "ui/widgets/landmarks.h"
#include "ui/widgets/look.h"
#include "ui/widgets/plot.h"

namespace handloop::ui {
namespace {

constexpr std::array<const char*, 4> kKinds{"Simulation", "Across a network (udp)", "Boards (Comedi)",
                                            "Replay of a log"};
constexpr std::array<const char*, 4> kKindNames{"device_sim", "device_udp", "device_comedi", "device_replay"};

}  // namespace

void DeviceView::choice(Bench& bench) {
  heading("Device");
  for (int i = 0; i < 4; ++i) {
    if (i > 0) ImGui::SameLine(0, px(4));
    if (push_button(kKindNames[static_cast<std::size_t>(i)], kKinds[static_cast<std::size_t>(i)], kind_ == i)) {
      kind_ = i;
      if (i == 0) bench.session.use_device("sim");
    }
  }
  if (kind_ == 0) {
    note("The MuJoCo plant of the scenario, in real time or slower. Nothing real moves.");
    return;
  }
  ImGui::SetNextItemWidth(px(330));
  std::string& address = kind_ == 1 ? udp_ : kind_ == 2 ? comedi_ : replay_;
  text_field("##address", address);
  mark("control.device_address");
  ImGui::SameLine();
  const std::string full = kind_ == 1   ? "udp://" + udp_
                           : kind_ == 2 ? "comedi" + (comedi_.empty() ? "" : ":" + comedi_)
                                        : "replay:" + replay_;
  if (push_button("use_device", "Use it")) bench.session.use_device(full);
  note(kind_ == 1   ? "HOST:PORT of a plant: handloop plant scenes/phantom_wall.toml --listen HOST:PORT"
       : kind_ == 2 ? "Wiring of the boards, a TOML file (docs/hardware.md); empty: the arm paper's rig"
                    : "A log.csv of handloop run");
}

void DeviceView::arming(Bench& bench) {
  auto& session = bench.session;
  heading(fmt::format("{}: {}", session.device_address(),
                      session.simulated()        ? "no arming needed"
                      : session.arming().armed() ? "ARMED"
                                                 : "not armed, no force")
              .c_str());
  if (session.simulated()) return;
  auto& arming = session.arming();
  const auto& p = palette();
  if (arming.armed()) {
    note(session.preparing() ? "starting ..."
         : session.running()
             ? "The loop runs. New gains reach it at once; any other change waits until it is armed anew."
             : session.problem());
    if (push_button("disarm", "Disarm", true, px(160))) session.disarm();
    return;
  }
  note(
      "Two actions: lift the cover, then hold the button for a second and a half. The wall will push as soon as it is "
      "armed.");
  bool open = arming.cover_open();
  if (ImGui::Checkbox("1. cover lifted: hands are clear, the emergency stop is within reach", &open)) {
    if (open) {
      arming.open_cover(bench.now_s);
    } else {
      arming.close_cover();
    }
  }
  mark("control.cover");
  ImGui::BeginDisabled(!arming.cover_open());
  push_button("arm", "2. hold to arm", false, px(220));
  const bool down = arming.cover_open() && ImGui::IsItemActive();
  const ImVec2 low = ImGui::GetItemRectMin(), high = ImGui::GetItemRectMax();
  const float share = static_cast<float>(arming.held_share(bench.now_s));
  ImGui::GetWindowDrawList()->AddRectFilled({low.x, high.y - px(4)}, {low.x + share * (high.x - low.x), high.y},
                                            packed(p.unstable));
  ImGui::EndDisabled();
  if (arming.hold(down, bench.now_s)) session.start_armed();
}

void DeviceView::figures(const Bench& bench) {
  const auto& session = bench.session;
  const auto& s = session.status();
  heading("Loop");
  const auto row = [](const char* name, const std::string& value) {
    ImGui::TextDisabled("%s", name);
    ImGui::SameLine(px(190));
    ImGui::TextUnformatted(value.c_str());
  };
  row("state", session.running() ? session.faulted() ? "stopped by a fault, force at zero" : "running" : "not running");
  row("samples", fmt::format("{}", s.steps));
  row("device time", fmt::format("{:.1f} s", s.device_time_s));
  row("device over wall time", fmt::format("{:.3f}", s.real_time_factor));
  row("one pass of the loop",
      fmt::format("p50 {:.1f}, p99 {:.1f}, p99.9 {:.1f}, max {:.0f} us", s.p50_us, s.p99_us, s.p99_9_us, s.max_us));
  row("missed deadlines", fmt::format("{}", s.missed_deadlines));
  row("gains in force", fmt::format("K {:.0f} N/m, B {:.2f} N s/m, filter {:.0f} Hz", s.gains.stiffness_N_per_m,
                                    s.gains.damping_Ns_per_m, s.gains.cutoff_Hz));
  if (session.change_waits()) note("Changes of the scenario wait until the loop is started anew.");
  if (const auto text = session.realtime_note(); !text.empty()) note("not granted: " + text);
}

void DeviceView::evidence(Bench& bench) {
  const auto& session = bench.session;
  if (!session.faulted()) return;
  const auto& fault = session.status().fault;
  const auto& info = device::fault_info(fault.fault);
  heading(fmt::format("Fault: {}", info.name).c_str());
  ImGui::TextWrapped("%s", std::string(info.meaning).c_str());
  if (!info.unit.empty())
    ImGui::Text("measured %.4g %s, allowed %.4g %s", fault.value, std::string(info.unit).c_str(), fault.limit,
                std::string(info.unit).c_str());
  const auto& records = session.evidence();
  if (records.empty()) return note("the evidence is being collected ...");
  std::vector<double> time, position, force, energy;
  const int row = models::device_row(bench.editor.axis());
  const double end = static_cast<double>(fault.time_ns) * 1e-9;
  for (const auto& record : records) {
    time.push_back(static_cast<double>(record.reading.time_ns) * 1e-9 - end);
    position.push_back(1e3 * (record.tip_m[row] - session.home_tip_m()[row]));
    force.push_back(record.written_force_N[row]);
    energy.push_back(1e3 * record.energy_J);
  }
  const float width = (ImGui::GetContentRegionAvail().x - px(16)) / 3, height = px(170);
  const auto picture = [&](const char* id, const char* title, const char* unit, const std::vector<double>& y,
                           std::size_t colour) {
    Plot plot({.id = id,
               .title = title,
               .x_label = "s from the fault",
               .y_label = unit,
               .x = {time.front(), time.back()},
               .y = range_of(y, 1e-3),
               .size = {width, height}});
    plot.vertical(0, palette().unstable, 1.5f);
    plot.line(time, y, palette().series[colour]);
  };
  picture("evidence_position", "Position", "mm", position, 0);
  ImGui::SameLine(0, px(8));
  picture("evidence_force", "Force written", "N", force, 1);
  ImGui::SameLine(0, px(8));
  picture("evidence_energy", "Energy given", "mJ", energy, 2);
  ImGui::SetNextItemWidth(px(300));
  text_field("##evidence_file", evidence_file_);
  ImGui::SameLine();
  if (push_button("save_evidence", "Save as CSV")) {
    session.write_evidence(evidence_file_);
    bench.say("evidence saved: " + evidence_file_);
  }
}

void DeviceView::show(Bench& bench) {
  ImGui::BeginChild("device", {0, 0}, true);
  choice(bench);
  ImGui::Separator();
  arming(bench);
  ImGui::Separator();
  figures(bench);
  evidence(bench);
  ImGui::EndChild();
}

}  // namespace handloop::ui
