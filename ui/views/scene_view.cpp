#include "ui/views/scene_view.h"

#include <fmt/format.h>

#include <cmath>

#include "ui/widgets/fields.h"
#include "ui/widgets/landmarks.h"
#include "ui/widgets/look.h"

namespace handloop::ui {
namespace {

constexpr float kReach = 28.0f;  ///< pixels about the stylus within which the mouse takes hold of it
constexpr sim::Pull kSpring{.anchor_m = {}, .stiffness_N_per_m = 120.0, .damping_Ns_per_m = 1.0, .limit_N = 4.0};

}  // namespace

SceneState SceneView::state(const Bench& bench) const {
  SceneState state;
  state.home_tip_m = state.tip_m = bench.session.home_tip_m();
  const auto& pose = bench.editor.scenario().device.pose_rad;
  state.joint_rad = {pose[0], pose[1], pose[2]};
  if (bench.session.has_record()) {
    const auto& record = bench.session.last();
    state.joint_rad = record.joint_rad;
    state.tip_m = record.tip_m;
    state.sensed_force_N = record.sensed_force_N;
    state.wall_force_N = record.limited_force_N;
    state.in_contact = record.in_contact;
  }
  if (pulling_) state.pull_anchor_m = anchor_m_;
  return state;
}

void SceneView::layout(Bench& bench, ImVec2 size) {
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2{0, 0});
  ImGui::BeginChild("scene", size, false, ImGuiWindowFlags_NoBackground | ImGuiWindowFlags_NoScrollbar);
  ImGui::PopStyleVar();
  const float bar = ImGui::GetFrameHeight() + px(8);
  low_ = ImGui::GetCursorScreenPos();
  const ImVec2 picture{ImGui::GetContentRegionAvail().x, ImGui::GetContentRegionAvail().y - bar};
  high_ = {low_.x + picture.x, low_.y + picture.y};
  shown_ = true;
  ImGui::InvisibleButton("picture", {std::max(picture.x, 1.0f), std::max(picture.y, 1.0f)},
                         ImGuiButtonFlags_MouseButtonLeft | ImGuiButtonFlags_MouseButtonRight);
  mark("scene");
  mouse(bench);
  auto* draw = ImGui::GetWindowDrawList();
  const auto& colours = palette_of(Brightness::dark).series;
  const auto label = [&](float line, const Colour& colour, const std::string& text) {
    const ImVec2 at{low_.x + px(8), low_.y + px(6) + line * px(16)};
    const float width = look().small->CalcTextSizeA(look().small->FontSize, 1e9f, 0, text.c_str()).x;
    draw->AddRectFilled({at.x - px(4), at.y - px(1)}, {at.x + width + px(20), at.y + px(15)},
                        IM_COL32(15, 18, 22, 170));
    draw->AddRectFilled({at.x, at.y + px(4)}, {at.x + px(10), at.y + px(9)}, packed(colour));
    draw->AddText(look().small, look().small->FontSize, {at.x + px(15), at.y}, IM_COL32(235, 238, 242, 255),
                  text.c_str());
  };
  if (bench.session.has_record()) {
    const auto& record = bench.session.last();
    label(0, colours[1], fmt::format("force on the hand {:.2f} N", record.sensed_force_N.norm()));
    label(1, colours[2],
          fmt::format("wall {:.2f} N{}", record.limited_force_N.norm(), record.in_contact ? ", in contact" : ""));
    if (pulling_) label(2, colours[4], "pulling");
  } else {
    label(0, colours[6], bench.session.preparing() ? "getting ready ..." : "no device is running");
  }
  clock(bench);
  ImGui::EndChild();
}

void SceneView::mouse(Bench& bench) {
  const auto& io = ImGui::GetIO();
  const ImVec2 size{high_.x - low_.x, high_.y - low_.y};
  const std::array<double, 2> place{static_cast<double>((io.MousePos.x - low_.x) / size.x),
                                    static_cast<double>((io.MousePos.y - low_.y) / size.y)};
  const auto tip = state(bench).tip_m;
  if (ImGui::IsItemClicked(ImGuiMouseButton_Left)) {
    const auto at = renderer_.place_of(tip);
    const float distance = std::hypot(static_cast<float>(at[0]) * size.x + low_.x - io.MousePos.x,
                                      static_cast<float>(at[1]) * size.y + low_.y - io.MousePos.y);
    pulling_ = bench.session.simulated() && (io.KeyCtrl || distance < px(kReach));
  }
  const bool left = ImGui::IsItemActive() && ImGui::IsMouseDown(ImGuiMouseButton_Left);
  const bool right = ImGui::IsItemActive() && ImGui::IsMouseDown(ImGuiMouseButton_Right);
  const double dx = static_cast<double>(io.MouseDelta.x / size.y), dy = static_cast<double>(io.MouseDelta.y / size.y);
  if (pulling_ && left) {
    anchor_m_ = renderer_.point_at(place, tip);
    auto pull = kSpring;
    pull.anchor_m = {anchor_m_->x(), anchor_m_->y(), anchor_m_->z()};
    bench.session.pull(pull);
  } else if (pulling_) {
    pulling_ = false;
    anchor_m_.reset();
    bench.session.pull({});
  } else if (left) {
    renderer_.orbit(dx, dy);
  } else if (right) {
    renderer_.pan(dx, dy);
  }
  if (ImGui::IsItemHovered()) {
    if (io.MouseWheel != 0.0f) renderer_.zoom(static_cast<double>(io.MouseWheel));
    if (ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left)) renderer_.reset_camera();
  }
}

void SceneView::clock(Bench& bench) {
  auto& session = bench.session;
  ImGui::SetCursorPosY(ImGui::GetCursorPosY() + px(2));
  if (!session.simulated()) {
    note("  a real device keeps its own time");
    return;
  }
  if (push_button("pause", session.paused() ? "Run" : "Pause", session.paused(), px(58)))
    session.set_paused(!session.paused());
  hint("Pause and go on (Ctrl+P)");
  ImGui::SameLine(0, px(4));
  if (push_button("step", "Step")) session.single_step();
  hint("One sample further (Ctrl+.)");
  ImGui::SameLine(0, px(4));
  if (push_button("reset", "Reset")) session.reset();
  hint("From the first sample again; clears a fault (F5)");
  ImGui::SameLine(0, px(4));
  ImGui::SetNextItemWidth(px(74));
  double speed = session.speed();
  const double low = 0.01, high = 1.0;
  if (ImGui::SliderScalar("##speed", ImGuiDataType_Double, &speed, &low, &high, "speed %.2f",
                          ImGuiSliderFlags_Logarithmic | ImGuiSliderFlags_AlwaysClamp))
    session.set_speed(speed);
  mark("control.speed");
  hint("Simulated time over real time: 1, or less for slow motion");
  ImGui::SameLine(0, px(6));
  const TextStyle style(look().small, palette().muted);
  ImGui::AlignTextToFramePadding();
  const auto& status = session.status();
  ImGui::Text("is %.2f  t %.1f s", session.paused() ? 0.0 : status.real_time_factor, status.device_time_s);
  hint("Measured over the last second, and the device's own time");
}

void SceneView::render(const Bench& bench, int framebuffer_height, float pixels_per_point) {
  if (!shown_) return;
  shown_ = false;
  Viewport where;
  where.left = static_cast<int>(low_.x * pixels_per_point);
  where.bottom = framebuffer_height - static_cast<int>(high_.y * pixels_per_point);
  where.width = static_cast<int>((high_.x - low_.x) * pixels_per_point);
  where.height = static_cast<int>((high_.y - low_.y) * pixels_per_point);
  renderer_.draw(state(bench), bench.editor.scenario(), where, palette().brightness == Brightness::dark);
}

}  // namespace handloop::ui
