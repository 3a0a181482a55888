#include "ui/views/controls_view.h"

#include <imgui.h>

#include <string>

#include "ui/views/effects_controls.h"
#include "ui/widgets/fields.h"
#include "ui/widgets/landmarks.h"
#include "ui/widgets/look.h"

namespace handloop::ui {
namespace {

/// A slider on one number of the scenario, with undo; shown in other units by a scale.

template <typename Get>
void slider(Bench& bench, const std::string& name, const char* label, Get get, double scale, double low, double high,
            const char* format, bool logarithmic, const char* tip) {
  auto copy = bench.editor.scenario();
  double value = get(copy) * scale;
  const auto edited = value_slider(name, label, value, low, high, format, logarithmic, tip);
  if (edited.changed) bench.editor.edit(label, [&](models::Scenario& s) { get(s) = value / scale; });
  if (edited.finished) bench.editor.seal();
}

void wall(Bench& bench) {
  using models::Scenario;
  slider(
      bench, "stiffness", "Stiffness K", [](Scenario& s) -> double& { return s.loop.stiffness_N_per_m; }, 1, 0, 20000,
      "%.0f N/m", true, "Of the virtual wall");
  slider(
      bench, "damping", "Damping B", [](Scenario& s) -> double& { return s.loop.damping_Ns_per_m; }, 1, 0, 40,
      "%.2f N s/m", true, "Of the virtual wall, on the filtered velocity");
  slider(
      bench, "cutoff", "Filter", [](Scenario& s) -> double& { return s.loop.cutoff_Hz; }, 1, 1, 2000, "%.0f Hz", true,
      "Cut-off of the velocity filter");
  int delay = bench.editor.scenario().loop.delay_samples;
  const auto edited = whole_slider("delay", "Delay", delay, 0, 8, "%d sample(s)", "Between reading and acting");
  if (edited.changed) bench.editor.edit("Delay", [&](Scenario& s) { s.loop.delay_samples = delay; });
  if (edited.finished) bench.editor.seal();
  slider(
      bench, "sample_time", "Period T", [](Scenario& s) -> double& { return s.loop.sample_time_s; }, 1e3, 0.1, 10,
      "%.2f ms", true, "Sampling period of the loop");
  slider(
      bench, "wall_position", "Wall at", [](Scenario& s) -> double& { return s.wall.position_m; }, 1e3, -50, 50,
      "%.1f mm", false, "Along the axis, from the tip at the pose");
  bool bilateral = bench.editor.scenario().wall.bilateral;
  if (ImGui::Checkbox("pulls as well (spring)", &bilateral)) {
    bench.editor.edit("wall kind", [&](Scenario& s) { s.wall.bilateral = bilateral; });
    bench.editor.seal();
  }
  mark("control.bilateral");
}

void device(Bench& bench) {
  using models::Scenario;
  slider(
      bench, "viscous", "Viscous fric.", [](Scenario& s) -> double& { return s.device.joint_viscous_Nms_per_rad; }, 1e3,
      0, 20, "%.2f mNms/rad", true, "Of each joint");
  slider(
      bench, "coulomb", "Dry friction", [](Scenario& s) -> double& { return s.device.joint_coulomb_Nm; }, 1e3, 0, 50,
      "%.1f mNm", true, "Of each joint. It has no linear stand-in here: the simulation feels it, the margins do not");
  slider(
      bench, "stylus", "Stylus", [](Scenario& s) -> double& { return s.device.stylus_mass_kg; }, 1e3, 5, 300, "%.0f g",
      false, "Stylus and gimbal at the tip");
}

void arm(Bench& bench) {
  auto& editor = bench.editor;
  note(editor.arm_source());
  bool attached = editor.scenario().arm.attached;
  if (ImGui::Checkbox("somebody holds the stylus", &attached)) {
    editor.edit("holding", [&](models::Scenario& s) { s.arm.attached = attached; });
    editor.seal();
  }
  mark("control.attached");
  const auto grip = [&](const char* name, const char* label, models::Grip which) {
    const bool chosen = attached && editor.arm() == models::published_arm(editor.axis(), which);
    if (push_button(name, label, chosen)) editor.set_grip(which);
    hint("Tables I and II of the arm paper, by grip force");
  };
  grip("grip_nominal", "Nominal", models::Grip::nominal);
  ImGui::SameLine(0, px(4));
  grip("grip_1", "1 N", models::Grip::one_N);
  ImGui::SameLine(0, px(4));
  grip("grip_2", "2 N", models::Grip::two_N);
  ImGui::SameLine(0, px(4));
  grip("grip_3", "3 N", models::Grip::three_N);
  ImGui::SameLine(0, px(4));
  static std::uint64_t subject = 0;
  if (push_button("draw_subject", "Subject")) editor.draw_subject(1, subject++);
  hint("Draws the next arm of the population of Table III");
}

void hand(Bench& bench) {
  using models::Scenario;
  slider(
      bench, "push", "Push", [](Scenario& s) -> double& { return s.hand.push_N; }, 1, -5, 8, "%.2f N", false,
      "Mean force of the hand into the wall");
  slider(
      bench, "disturbance", "Tremble", [](Scenario& s) -> double& { return s.hand.disturbance_N; }, 1, 0, 4,
      "%.2f N rms", false, "Noise up to 30 Hz added to the push");
}

}  // namespace

void controls_view(Bench& bench) {
  auto& editor = bench.editor;
  ImGui::AlignTextToFramePadding();
  ImGui::TextUnformatted("Axis");
  const bool narrow = ImGui::GetContentRegionAvail().x < px(300);
  const auto labels = narrow ? std::array{"x", "y", "z"} : std::array{"x left-right", "y up-down", "z fore-aft"};
  constexpr std::array kNames{"axis_x", "axis_y", "axis_z"};
  for (const auto axis : models::kAxes) {
    const auto i = static_cast<std::size_t>(axis);
    ImGui::SameLine(0, px(6));
    if (push_button(kNames[i], labels[i], editor.axis() == axis)) editor.set_axis(axis);
  }
  const auto section = [&](const char* title, bool open, auto&& content) {
    ImGui::SetNextItemOpen(open, ImGuiCond_Once);
    if (ImGui::CollapsingHeader(title)) content(bench);
    mark(std::string("section.") + title);
  };
  section("Wall and controller", true, wall);
  section("Arm", true, arm);
  section("Effects", true, effects_controls);
  section("Hand", false, hand);
  section("Device", false, device);
}

}  // namespace handloop::ui
