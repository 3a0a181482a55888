#pragma once

#include <imgui.h>

#include "ui/widgets/theme.h"

namespace handloop::ui {

/// How everything looks now: set by the window before each frame, read by every view.
struct Look {
  const Palette* palette = nullptr;
  float scale = 1.0f;  ///< of everything: 1 to 2
  ImFont *body = nullptr, *small = nullptr, *bold = nullptr, *title = nullptr;
};
const Look& look();

/// Loads the fonts for a scale and sets ImGui's style to the palette. Between frames only; the renderer's font texture
/// must be made anew.
void apply_look(Brightness brightness, float scale);

inline const Palette& palette() {
  return *look().palette;
}
inline ImU32 packed(const Colour& colour) {
  return colour.packed();
}
inline ImVec4 vec(const Colour& c) {
  return {c.r, c.g, c.b, c.a};
}
/// Pixels of a length at 100 %.
inline float px(float at_100_percent) {
  return at_100_percent * look().scale;
}

/// Text of one font in one colour for as long as it lives.
class TextStyle {
 public:
  TextStyle(ImFont* font, const Colour& colour) {
    ImGui::PushFont(font);
    ImGui::PushStyleColor(ImGuiCol_Text, vec(colour));
  }
  ~TextStyle() {
    ImGui::PopStyleColor();
    ImGui::PopFont();
  }
  TextStyle(const TextStyle&) = delete;
  TextStyle& operator=(const TextStyle&) = delete;
};

}  // namespace handloop::ui
