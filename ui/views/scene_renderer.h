#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <optional>

#include "models/scenario.h"

namespace handloop::ui {

/// What the scene shows at one moment, as the loop knows it: the same for a simulated and a real device.
struct SceneState {
  Eigen::Vector3d joint_rad = Eigen::Vector3d::Zero();
  Eigen::Vector3d tip_m = Eigen::Vector3d::Zero();  ///< device frame
  Eigen::Vector3d home_tip_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d sensed_force_N = Eigen::Vector3d::Zero();  ///< of the device on the hand
  Eigen::Vector3d wall_force_N = Eigen::Vector3d::Zero();    ///< that the controller asks for
  std::optional<Eigen::Vector3d> pull_anchor_m;
  bool in_contact = false;
};

/// A rectangle of the framebuffer, pixels from its lower left corner.
struct Viewport {
  int left = 0, bottom = 0, width = 0, height = 0;
};

/// MuJoCo's renderer in a part of the window: a twin of the device, posed by what the loop reports and never stepped.
/// Every member needs the window's OpenGL context.
class SceneRenderer {
 public:
  /// Throws InputError where the scene cannot be loaded.
  explicit SceneRenderer(const models::Scenario& scenario);
  ~SceneRenderer();
  SceneRenderer(const SceneRenderer&) = delete;
  SceneRenderer& operator=(const SceneRenderer&) = delete;

  void draw(const SceneState& state, const models::Scenario& scenario, const Viewport& where, bool dark);

  // ---- camera: shares of the picture's height the mouse moved ------------------------------------------------------
  void orbit(double right, double down);
  void pan(double right, double down);
  void zoom(double steps);
  void reset_camera();

  /// Where a point is in the picture as last drawn: shares of width and height from the upper left corner.
  std::array<double, 2> place_of(const Eigen::Vector3d& point_m) const;
  /// The point of the picture at the depth of another point.
  Eigen::Vector3d point_at(const std::array<double, 2>& place, const Eigen::Vector3d& at_depth_of_m) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace handloop::ui
