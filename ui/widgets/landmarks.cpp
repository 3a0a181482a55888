#include "ui/widgets/landmarks.h"

namespace handloop::ui {

Landmarks& Landmarks::all() {
  static Landmarks landmarks;
  return landmarks;
}

void Landmarks::add(std::string name, ImVec2 low, ImVec2 high, std::string text) {
  if (listening) entries_.push_back({std::move(name), low, high, std::move(text)});
}

void mark(const std::string& name, const std::string& text) {
  auto& landmarks = Landmarks::all();
  if (landmarks.listening) landmarks.add(name, ImGui::GetItemRectMin(), ImGui::GetItemRectMax(), text);
}

}  // namespace handloop::ui
