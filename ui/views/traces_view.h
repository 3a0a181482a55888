#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "ui/traces/trace_window.h"
#include "ui/views/bench.h"

namespace handloop::ui {

/// A rectangle of the window to be saved as a picture after the frame is drawn.
struct PictureRequest {
  std::string path;
  float left = 0, top = 0, right = 0, bottom = 0;
};

/// What the loop does, scrolling: position, force, torque, counts, energy, the time of each pass.
class TracesView {
 public:
  void show(Bench& bench);
  std::optional<PictureRequest> take_picture_request() { return std::exchange(picture_, std::nullopt); }

 private:
  struct Group {
    const char* name;
    std::vector<Channel> channels;
    bool shown;
  };
  void bar(Bench& bench);
  void group(Bench& bench, const Group& group, float height, bool last);
  void mouse(const class Plot& plot);
  void deadlines(const Bench& bench, float height);
  void export_csv(Bench& bench);

  std::vector<Group> groups_ = default_groups();
  static std::vector<Group> default_groups();
  TraceWindow window_;
  bool log_ = false;
  bool deadlines_ = true;
  std::optional<double> cursor_a_s_, cursor_b_s_;
  std::string csv_ = "traces.csv", png_ = "traces.png";
  std::optional<PictureRequest> picture_;
};

}  // namespace handloop::ui
