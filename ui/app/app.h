#pragma once

#include <functional>
#include <memory>
#include <string>

#include "ui/app/panel.h"
#include "ui/app/shortcuts.h"
#include "ui/app/window.h"
#include "ui/views/arms_view.h"
#include "ui/views/bench.h"
#include "ui/views/data_view.h"
#include "ui/views/device_view.h"
#include "ui/views/scene_view.h"
#include "ui/views/traces_view.h"
#include "ui/widgets/file_dialog.h"
#include "ui/widgets/theme.h"

namespace handloop::ui {

/// The panel: one window, its parts laid out, keys turned into what they mean.
class App {
 public:
  explicit App(const PanelOptions& options);

  /// Draws until the window is closed or the screenshot is taken.
  void run();

 private:
  void frame();
  void obey(Command command);
  void layout();
  void top_bar();
  /// The commands as buttons, in a line or one below the other.
  void bar_commands(bool beside);
  void fault_banner();
  void status_line();
  void current_view();
  void after_drawing();
  void describe();
  void ask_open();
  void ask_save();
  void file_chosen(const std::filesystem::path& path);
  void save(const std::filesystem::path& path);
  template <typename Work>
  void attempt(Work&& work);

  PanelOptions options_;  ///< checked, with what follows, before there is a window
  Brightness brightness_;
  View first_view_;
  Window window_;
  Bench bench_;
  SceneView scene_;
  ArmsView arms_;
  DataView data_;
  TracesView traces_;
  DeviceView device_;
  FileDialog dialog_;
  std::function<void(const std::filesystem::path&)> when_chosen_;
  float scale_;
  bool look_changed_ = true, picture_wanted_ = false;
  std::string described_;
  double last_described_s_ = -1.0;
  std::uint64_t frames_ = 0;
  double longest_layout_s_ = 0.0;  ///< of all a frame does but draw
};

}  // namespace handloop::ui
