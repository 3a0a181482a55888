#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

struct GLFWwindow;

namespace handloop::ui {

/// A key of the keyboard with what was held down, as GLFW numbers them.
struct KeyPress {
  int key = 0, modifiers = 0;
};

/// One window with OpenGL and ImGui in it.
class Window {
 public:
  /// Throws InputError where there is no display or no OpenGL.
  Window(int width, int height, const std::string& title);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  bool closing() const;
  void close();
  /// Keys pressed since last asked.
  std::vector<KeyPress> take_keys();
  /// Monitor's scale, 1 for 96 dots an inch.
  float content_scale() const;
  /// Fonts were loaded anew.
  void fonts_changed();

  void begin_frame();
  /// Draws: `under` first (OpenGL; told the framebuffer's height and its pixels a point), then what ImGui was given.
  void end_frame(const std::function<void(int, float)>& under, float red, float green, float blue);
  void show_frame();

  struct Pixels {
    int width = 0, height = 0;
    std::vector<unsigned char> rgb;  ///< rows from the top
  };
  /// What was drawn, before show_frame(): of the whole window, or of a part (points from the upper left corner).
  Pixels pixels() const;
  Pixels pixels(float left, float top, float right, float bottom) const;

 private:
  GLFWwindow* window_ = nullptr;
  std::vector<KeyPress> keys_;
};

/// As a PNG file's bytes.
std::string png(const Window::Pixels& pixels);

}  // namespace handloop::ui
