#include "ui/widgets/fields.h"

#include <array>

#include "ui/widgets/landmarks.h"
#include "ui/widgets/look.h"

namespace handloop::ui {
namespace {

/// The label, and the rest of the line for the field.
void begin_field(const char* label) {
  const float line = ImGui::GetCursorPosX();
  ImGui::AlignTextToFramePadding();
  ImGui::TextUnformatted(label);
  ImGui::SameLine(line + px(112));
  ImGui::SetNextItemWidth(-1);
}

Edited end_field(const std::string& name, bool changed, const char* tip) {
  mark("control." + name);
  if (tip != nullptr) hint(tip);
  return {changed, ImGui::IsItemDeactivatedAfterEdit()};
}

}  // namespace

Edited value_slider(const std::string& name, const char* label, double& value, double low, double high,
                    const char* format, bool logarithmic, const char* tip) {
  begin_field(label);
  const ImGuiSliderFlags flags =
      ImGuiSliderFlags_AlwaysClamp | (logarithmic ? ImGuiSliderFlags_Logarithmic : ImGuiSliderFlags_None);
  const bool changed =
      ImGui::SliderScalar(("##" + name).c_str(), ImGuiDataType_Double, &value, &low, &high, format, flags);
  return end_field(name, changed, tip);
}

Edited whole_slider(const std::string& name, const char* label, int& value, int low, int high, const char* format,
                    const char* tip) {
  begin_field(label);
  const bool changed = ImGui::SliderInt(("##" + name).c_str(), &value, low, high, format, ImGuiSliderFlags_AlwaysClamp);
  return end_field(name, changed, tip);
}

bool push_button(const std::string& name, const char* label, bool chosen, float width) {
  if (chosen) {
    ImGui::PushStyleColor(ImGuiCol_Button, vec(palette().accent.faded(0.45f)));
    ImGui::PushStyleColor(ImGuiCol_ButtonHovered, vec(palette().accent.faded(0.6f)));
  }
  const bool pressed = ImGui::Button((std::string(label) + "##" + name).c_str(), {width, 0});
  if (chosen) ImGui::PopStyleColor(2);
  mark("button." + name);
  return pressed;
}

bool text_field(const char* id, std::string& text) {
  // a buffer of our own: where ImGui keeps its form for std::string differs between packages
  std::array<char, 1024> buffer{};
  text.copy(buffer.data(), buffer.size() - 1);
  const bool entered = ImGui::InputText(id, buffer.data(), buffer.size(), ImGuiInputTextFlags_EnterReturnsTrue);
  text = buffer.data();
  return entered;
}

void hint(const char* text) {
  if (!ImGui::IsItemHovered()) return;
  // not before the mouse has rested: a tip that jumps up hides what is being aimed at
  constexpr double kRest_s = 0.6;
  static ImVec2 last{-1, -1};
  static double since_s = 0.0;
  const ImVec2 item = ImGui::GetItemRectMin();
  const auto& moved = ImGui::GetIO().MouseDelta;
  if (item.x != last.x || item.y != last.y || moved.x != 0 || moved.y != 0 || ImGui::IsAnyMouseDown()) {
    last = item;
    since_s = ImGui::GetTime();
  }
  if (ImGui::GetTime() - since_s < kRest_s) return;
  ImGui::BeginTooltip();
  ImGui::PushTextWrapPos(px(320));
  ImGui::TextUnformatted(text);
  ImGui::PopTextWrapPos();
  ImGui::EndTooltip();
}

void note(const std::string& text) {
  const TextStyle style(look().small, palette().muted);
  ImGui::PushTextWrapPos(0.0f);
  ImGui::TextUnformatted(text.c_str());
  ImGui::PopTextWrapPos();
}

void heading(const char* text) {
  ImGui::Dummy({0, px(2)});
  const TextStyle style(look().bold, palette().text);
  ImGui::TextUnformatted(text);
}

}  // namespace handloop::ui
