#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace handloop::ui {

/// A screen of its own with a panel on it, and a person's hands: Xvfb and xdotool. What the panel shows is read from
/// the file it keeps up to date (--describe).
class Desktop {
 public:
  /// Xvfb and xdotool are installed.
  static bool possible();
  /// Where pictures of the tests are kept.
  static std::string pictures();

  explicit Desktop(const std::vector<std::string>& arguments, int width = 1280, int height = 800);
  ~Desktop();
  Desktop(const Desktop&) = delete;
  Desktop& operator=(const Desktop&) = delete;

  nlohmann::json shown() const;
  /// Waits until the panel shows what is expected; false after a minute (longer under a sanitizer).
  bool until(const std::function<bool(const nlohmann::json&)>& come, int seconds = 60) const;
  bool until_named(const std::string& landmark) const;

  /// At a share of a named thing, from its upper left corner.
  void click(const std::string& landmark, double right = 0.5, double down = 0.5);
  /// Ctrl and a click on a slider, then the number and Enter; again, more slowly, where the panel was too busy to see
  /// it. True once it shows the value under its key.
  bool type_value(const std::string& slider, const std::string& value, const std::string& key);
  void move_to(const std::string& landmark, double right = 0.5, double down = 0.5);
  void press(bool down);
  void keys(const std::string& combination);
  void type(const std::string& text);
  /// Saves what the panel shows among the pictures.
  void picture(const std::string& name);
  /// Ends the panel as Ctrl+Q does; its exit code.
  int quit();
  bool alive() const;

 private:
  void rest() const;
  void xdotool(const std::vector<std::string>& arguments) const;

  int hold_ms_ = 150;             ///< ImGui 1.86 has no event queue: a key or button must be down in a frame to be seen
  int screen_ = -1, panel_ = -1;  ///< processes
  std::string display_, folder_;
};

}  // namespace handloop::ui
