#pragma once

#include <imgui.h>

#include <span>
#include <string>
#include <vector>

#include "ui/widgets/axis_ticks.h"
#include "ui/widgets/theme.h"

namespace handloop::ui {

/// A plot drawn with ImGui's lines: frame, grid and labels when made, curves as they are added, all cut at the frame.
/// (ImPlot is in no Debian suite.) The whole plot is one item for mouse and keyboard.
class Plot {
 public:
  struct Spec {
    std::string id;  ///< also its landmark, "plot.ID"
    std::string title, x_label, y_label;
    AxisRange x, y;
    ImVec2 size;
    bool round = false;  ///< one unit is as long up as sideways: y is stretched about its middle
  };
  enum class Mark { dot, ring, cross, diamond };

  explicit Plot(Spec spec);
  ~Plot();
  Plot(const Plot&) = delete;
  Plot& operator=(const Plot&) = delete;

  const AxisRange& x() const { return spec_.x; }
  const AxisRange& y() const { return spec_.y; }
  ImVec2 at(double x, double y) const;
  double x_at(float pixel) const;
  double y_at(float pixel) const;
  float left() const { return low_.x; }
  float right() const { return high_.x; }
  float top() const { return low_.y; }
  float bottom() const { return high_.y; }

  /// Missing values (NaN) break the line.
  void line(std::span<const double> x, std::span<const double> y, const Colour& colour, float width = 1.6f);
  void dashed(std::span<const double> x, std::span<const double> y, const Colour& colour, float width = 1.4f);
  void area(std::span<const double> x, std::span<const double> low, std::span<const double> high, const Colour& colour);
  void bar(double x_low, double x_high, double y_low, double y_high, const Colour& colour);
  void mark(double x, double y, const Colour& colour, Mark shape = Mark::dot, float radius = 4.0f);
  void vertical(double x, const Colour& colour, float width = 1.0f);
  void horizontal(double y, const Colour& colour, float width = 1.0f);
  void circle(double x, double y, double radius, const Colour& colour, bool filled, float width = 1.4f);
  /// Beside the point, by an offset in pixels at 100 %.
  void text(double x, double y, const std::string& text, const Colour& colour, ImVec2 offset = {5, -14});
  /// Names of curves, in the upper right corner (or the lower left).
  void legend(std::initializer_list<std::pair<const char*, Colour>> entries, bool lower_left = false);

  bool hovered() const { return hovered_; }
  bool clicked() const { return clicked_; }
  bool dragged() const { return active_; }
  /// Where the mouse is, in the plot's units.
  ImVec2 mouse() const;
  double mouse_x() const { return x_at(mouse().x); }
  double mouse_y() const { return y_at(mouse().y); }
  /// A line of text at the mouse.
  void read_out(const std::string& text);
  ImDrawList* draw() const { return draw_; }

 private:
  void frame();
  void polyline(std::vector<ImVec2>& points, const Colour& colour, float width);

  Spec spec_;
  ImDrawList* draw_;
  ImVec2 low_, high_;  ///< corners of the frame
  bool hovered_ = false, clicked_ = false, active_ = false;
};

/// A range that holds the values with a little room; `least` is its smallest length.
AxisRange range_of(std::span<const double> values, double least = 1e-9);

}  // namespace handloop::ui
