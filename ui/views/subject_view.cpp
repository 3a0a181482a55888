#include "ui/views/subject_view.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "ui/state/grip_colour.h"
#include "ui/widgets/fields.h"
#include "ui/widgets/landmarks.h"
#include "ui/widgets/look.h"

namespace handloop::ui {
namespace {

using Eigen::Vector3d;

constexpr double kBar_m = 0.075;     ///< half length of a crossbar
constexpr double kBox_m = 0.008;     ///< half side of the target
constexpr double kCursor_m = 0.004;  ///< radius
constexpr double kEye_m = 0.5;       ///< distance of the subject's eyes
constexpr double kMostGrip_N = 4.0;

Colour colour_of(GripLabel label) {
  constexpr std::array<Colour, 4> kColours{Colour{0.75f, 0.75f, 0.75f, 1}, Colour{0.95f, 0.10f, 0.10f, 1},
                                           Colour{0, 0.9f, 0.95f, 1}, Colour{0.95f, 0.1f, 0.9f, 1}};
  return kColours[static_cast<std::size_t>(label)];
}

/// Looks along the subject's line of sight, from a little above and beside so that depth shows without the paper's
/// shutter glasses. Hand axes: x right, y up, z towards the subject.
class Eye {
 public:
  Eye(ImVec2 centre, float pixels_per_m) : centre_(centre), scale_(pixels_per_m) {}
  ImVec2 see(const Vector3d& p) const {
    constexpr double kTurn = 0.38, kTilt = 0.30;
    const double x = std::cos(kTurn) * p.x() - std::sin(kTurn) * p.z(),
                 z = std::sin(kTurn) * p.x() + std::cos(kTurn) * p.z();
    const double y = std::cos(kTilt) * p.y() - std::sin(kTilt) * z,
                 depth = std::sin(kTilt) * p.y() + std::cos(kTilt) * z;
    const double nearer = kEye_m / std::max(kEye_m - depth, 0.05);
    return {centre_.x + static_cast<float>(x * nearer) * scale_, centre_.y - static_cast<float>(y * nearer) * scale_};
  }
  float size(const Vector3d& p, double metres) const {
    const ImVec2 a = see(p), b = see(p + Vector3d(0, metres, 0));
    return std::max(std::hypot(b.x - a.x, b.y - a.y), 2.0f);
  }

 private:
  ImVec2 centre_;
  float scale_;
};

void box(ImDrawList* draw, const Eye& eye, bool inside) {
  const Colour green{0.2f, 0.85f, 0.35f, inside ? 0.40f : 0.22f};
  const auto corner = [&](int i) {
    return eye.see({i & 1 ? kBox_m : -kBox_m, i & 2 ? kBox_m : -kBox_m, i & 4 ? kBox_m : -kBox_m});
  };
  constexpr std::array<std::array<int, 4>, 6> kFaces{
      {{0, 1, 3, 2}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 3, 7, 5}}};
  for (const auto& f : kFaces) {
    draw->AddQuadFilled(corner(f[0]), corner(f[1]), corner(f[2]), corner(f[3]), packed(green.faded(0.5f * green.a)));
    draw->AddQuad(corner(f[0]), corner(f[1]), corner(f[2]), corner(f[3]), packed(green.faded(0.8f)), 1.0f);
  }
}

void gauge(ImDrawList* draw, ImVec2 low, ImVec2 high, double grip_N) {
  const auto place = [&](double N) {
    return high.y - static_cast<float>(std::clamp(N / kMostGrip_N, 0.0, 1.0)) * (high.y - low.y);
  };
  draw->AddRectFilled(low, high, IM_COL32(30, 34, 40, 255), px(3));
  draw->AddRectFilled({low.x, place(grip_N)}, high, packed(colour_of(grip_label(grip_N)).faded(0.85f)), px(3));
  draw->AddRect(low, high, IM_COL32(160, 170, 180, 255), px(3));
  for (int N = 1; N <= 3; ++N) {
    const auto colour = packed(colour_of(static_cast<GripLabel>(N)));
    draw->AddLine({low.x - px(8), place(N)}, {high.x + px(4), place(N)}, colour, px(2));
    draw->AddText(look().bold, look().bold->FontSize, {low.x - px(42), place(N) - px(9)}, colour,
                  fmt::format("{} N", N).c_str());
  }
  draw->AddText(look().small, look().small->FontSize, {low.x - px(30), low.y - px(20)}, IM_COL32(200, 206, 212, 255),
                fmt::format("grip {:.2f} N", grip_N).c_str());
}

}  // namespace

void subject_view(Bench& bench) {
  ImGui::BeginChild("subject", {0, 0}, true, ImGuiWindowFlags_NoScrollbar);
  double grip = bench.editor.scenario().arm.grip_force_N;
  ImGui::PushItemWidth(px(400));
  const auto edited = value_slider("grip_force", "Grip force", grip, 0.0, kMostGrip_N, "%.2f N", false,
                                   "How hard the simulated hand pinches the stylus");
  ImGui::PopItemWidth();
  if (edited.changed) bench.editor.edit("grip force", [&](models::Scenario& s) { s.arm.grip_force_N = grip; });
  if (edited.finished) bench.editor.seal();
  note(
      "What the subjects of the arm paper saw: hold the grip force that the colour names, and keep the sphere inside "
      "the green box. 1:1 on a screen of 96 dots an inch at 100 %.");
  const ImVec2 low = ImGui::GetCursorScreenPos();
  const ImVec2 room = ImGui::GetContentRegionAvail();
  const ImVec2 high{low.x + std::max(room.x, px(200)), low.y + std::max(room.y, px(200))};
  ImGui::Dummy({high.x - low.x, high.y - low.y});
  auto* draw = ImGui::GetWindowDrawList();
  draw->PushClipRect(low, high, true);
  draw->AddRectFilled(low, high, IM_COL32(8, 9, 12, 255), px(4));
  const Eye eye({0.5f * (low.x + high.x), 0.5f * (low.y + high.y)}, px(3780));
  for (int axis = 0; axis < 3; ++axis) {
    Vector3d end = Vector3d::Zero();
    end[axis] = kBar_m;
    draw->AddLine(eye.see(-end), eye.see(end), IM_COL32(50, 90, 220, 255), px(5));
  }
  const auto& session = bench.session;
  Vector3d tip = Vector3d::Zero();
  double grip_N = 0.0;
  if (session.has_record()) {
    const auto& record = session.last();
    for (const auto a : models::kAxes) {
      const int row = models::device_row(a);
      tip[static_cast<Eigen::Index>(a)] = record.tip_m[row] - session.home_tip_m()[row];
    }
    grip_N = record.grip_force_N;
  }
  const bool inside = tip.cwiseAbs().maxCoeff() < kBox_m;
  const bool behind = tip.z() < -kBox_m;
  const auto cursor = [&] {
    const auto colour = colour_of(grip_label(grip_N));
    const ImVec2 at = eye.see(tip);
    const float radius = eye.size(tip, kCursor_m);
    draw->AddCircleFilled(at, radius, packed(colour));
    draw->AddCircleFilled({at.x - 0.3f * radius, at.y - 0.35f * radius}, 0.28f * radius, IM_COL32(255, 255, 255, 150));
  };
  if (behind) cursor();
  box(draw, eye, inside);
  if (!behind) cursor();
  gauge(draw, {high.x - px(46), high.y - px(190)}, {high.x - px(24), high.y - px(18)}, grip_N);
  const std::string where =
      fmt::format("{}   x {:+.1f}  y {:+.1f}  z {:+.1f} mm", inside ? "on the target" : "off the target", 1e3 * tip.x(),
                  1e3 * tip.y(), 1e3 * tip.z());
  draw->AddText(look().small, look().small->FontSize, {low.x + px(12), high.y - px(24)}, IM_COL32(200, 206, 212, 255),
                where.c_str());
  Landmarks::all().add("subject", low, high, where);
  draw->PopClipRect();
  ImGui::EndChild();
}

}  // namespace handloop::ui
