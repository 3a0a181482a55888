#pragma once

#include <imgui.h>

#include <optional>

#include "ui/views/bench.h"
#include "ui/views/scene_renderer.h"

namespace handloop::ui {

/// The device, the hand and the wall, with the simulation's clock below; the mouse turns the camera or pulls at the
/// stylus.
class SceneView {
 public:
  explicit SceneView(const models::Scenario& scenario) : renderer_(scenario) {}

  /// Lays the view out in the present window's next `size` pixels.
  void layout(Bench& bench, ImVec2 size);
  /// Draws the picture under the window; before ImGui's own drawing.
  void render(const Bench& bench, int framebuffer_height, float pixels_per_point);

 private:
  void mouse(Bench& bench);
  void clock(Bench& bench);
  SceneState state(const Bench& bench) const;

  SceneRenderer renderer_;
  ImVec2 low_{}, high_{};
  bool shown_ = false;
  bool pulling_ = false;
  std::optional<Eigen::Vector3d> anchor_m_;
};

}  // namespace handloop::ui
