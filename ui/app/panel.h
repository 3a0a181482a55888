#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "models/scenario.h"

namespace handloop::ui {

struct PanelOptions {
  models::Scenario scenario;
  std::filesystem::path scenario_path;  ///< where Save writes; may be empty
  /// Draws `frames` frames, saves what the window shows as PNG, and ends.
  std::optional<std::filesystem::path> screenshot;
  int frames = 60;
  int width = 1280, height = 800;
  double scale = 0.0;          ///< 1 to 2; 0: the monitor's
  std::string theme = "dark";  ///< dark or light
  std::string view = "tune";   ///< tune, arms, subject, data, traces or device
  std::string recording;       ///< opened in the data view
  /// What is on the screen, as JSON: rewritten as it changes. For scripts and tests.
  std::optional<std::filesystem::path> describe;
};

/// Opens the window and returns when it is closed. Throws InputError where there is no display, OpenGL is too old, an
/// option is not possible or a file cannot be written.
void run_panel(const PanelOptions& options);

}  // namespace handloop::ui
