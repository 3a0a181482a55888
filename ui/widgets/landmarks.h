#pragma once

#include <imgui.h>

#include <string>
#include <vector>

namespace handloop::ui {

/// Where named things are on the screen: written to a file by `panel --describe`, so that scripts, tests and aids can
/// find them. Nothing is kept unless somebody listens.
class Landmarks {
 public:
  struct Entry {
    std::string name;
    ImVec2 low, high;  ///< corners, pixels from the window's upper left
    std::string text;  ///< what it says, where that is worth knowing
  };

  static Landmarks& all();
  bool listening = false;
  void begin_frame() { entries_.clear(); }
  void add(std::string name, ImVec2 low, ImVec2 high, std::string text = "");
  const std::vector<Entry>& entries() const { return entries_; }

 private:
  std::vector<Entry> entries_;
};

/// Names the item ImGui was given last.
void mark(const std::string& name, const std::string& text = "");

}  // namespace handloop::ui
