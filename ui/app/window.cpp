#include "ui/app/window.h"

// GLFW is to bring its own OpenGL header, nothing newer.
#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>
#include <png.h>

#include <algorithm>
#include <cstdlib>
#include <utility>

#include "models/errors.h"
#include "ui/widgets/look.h"

namespace handloop::ui {
namespace {

std::string last_glfw_error;

/// Keys are needed as pressed, whatever ImGui's version makes of them.
void on_key(GLFWwindow* window, int key, int, int action, int modifiers) {
  if (action != GLFW_PRESS && action != GLFW_REPEAT) return;
  static_cast<std::vector<KeyPress>*>(glfwGetWindowUserPointer(window))->push_back({key, modifiers});
}

bool display_is_named() {
  const char* display = std::getenv("DISPLAY");
  const char* wayland = std::getenv("WAYLAND_DISPLAY");
  return (display != nullptr && *display != '\0') || (wayland != nullptr && *wayland != '\0');
}

[[noreturn]] void no_display() {
  const std::string why = display_is_named() ? last_glfw_error.empty() ? "the display does not answer" : last_glfw_error
                                             : "$DISPLAY is not set";
  throw InputError("panel: there is no display to draw on (" + why +
                   "); without a screen: xvfb-run -s '-screen 0 1280x800x24' handloop panel --screenshot panel.png");
}

}  // namespace

Window::Window(int width, int height, const std::string& title) {
  glfwSetErrorCallback([](int, const char* text) { last_glfw_error = text; });
  // GLFW 3.4 would look for Wayland all the same, whose library then prints a line of its own.
  if (!display_is_named() || glfwInit() != GLFW_TRUE) no_display();
  window_ = glfwCreateWindow(width, height, title.c_str(), nullptr, nullptr);
  if (window_ == nullptr) {
    glfwTerminate();
    no_display();
  }
  glfwMakeContextCurrent(window_);
  glfwSwapInterval(1);
  glfwSetWindowUserPointer(window_, &keys_);
  glfwSetKeyCallback(window_, on_key);  // ImGui's own calls it in turn
  IMGUI_CHECKVERSION();
  ImGui::CreateContext();
  auto& io = ImGui::GetIO();
  io.IniFilename = nullptr;
  io.ConfigFlags |= ImGuiConfigFlags_NavEnableKeyboard;
  ImGui_ImplGlfw_InitForOpenGL(window_, true);
  if (!ImGui_ImplOpenGL3_Init("#version 130")) throw InputError("panel: this display has no OpenGL 3");
}

Window::~Window() {
  ImGui_ImplOpenGL3_Shutdown();
  ImGui_ImplGlfw_Shutdown();
  ImGui::DestroyContext();
  glfwDestroyWindow(window_);
  glfwTerminate();
}

bool Window::closing() const {
  return glfwWindowShouldClose(window_) != 0;
}

void Window::close() {
  glfwSetWindowShouldClose(window_, GLFW_TRUE);
}

std::vector<KeyPress> Window::take_keys() {
  return std::exchange(keys_, {});
}

float Window::content_scale() const {
  float x = 1, y = 1;
  glfwGetWindowContentScale(window_, &x, &y);
  return std::max(x, y);
}

void Window::fonts_changed() {
  ImGui_ImplOpenGL3_DestroyFontsTexture();
  ImGui_ImplOpenGL3_CreateFontsTexture();
}

void Window::begin_frame() {
  glfwPollEvents();
  ImGui_ImplOpenGL3_NewFrame();
  ImGui_ImplGlfw_NewFrame();
  ImGui::NewFrame();
}

void Window::end_frame(const std::function<void(int, float)>& under, float red, float green, float blue) {
  ImGui::Render();
  int width = 0, height = 0;
  glfwGetFramebufferSize(window_, &width, &height);
  glDisable(GL_SCISSOR_TEST);
  glViewport(0, 0, width, height);
  glClearColor(red, green, blue, 1.0f);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  under(height, ImGui::GetIO().DisplayFramebufferScale.x);
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

void Window::show_frame() {
  glfwSwapBuffers(window_);
}

Window::Pixels Window::pixels() const {
  const auto& size = ImGui::GetIO().DisplaySize;
  return pixels(0, 0, size.x, size.y);
}

Window::Pixels Window::pixels(float left, float top, float right, float bottom) const {
  int width = 0, height = 0;
  glfwGetFramebufferSize(window_, &width, &height);
  const float scale = ImGui::GetIO().DisplayFramebufferScale.x;
  const int x0 = std::clamp(static_cast<int>(left * scale), 0, width),
            x1 = std::clamp(static_cast<int>(right * scale), x0, width);
  const int y0 = std::clamp(static_cast<int>(top * scale), 0, height),
            y1 = std::clamp(static_cast<int>(bottom * scale), y0, height);
  Pixels result;
  result.width = x1 - x0;
  result.height = y1 - y0;
  const auto row = static_cast<std::size_t>(3 * result.width);
  std::vector<unsigned char> upside_down(row * static_cast<std::size_t>(result.height));
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadBuffer(GL_BACK);
  glReadPixels(x0, height - y1, result.width, result.height, GL_RGB, GL_UNSIGNED_BYTE, upside_down.data());
  result.rgb.resize(upside_down.size());
  for (std::size_t y = 0; y < static_cast<std::size_t>(result.height); ++y) {
    std::copy_n(upside_down.data() + (static_cast<std::size_t>(result.height) - 1 - y) * row, row,
                result.rgb.data() + y * row);
  }
  return result;
}

std::string png(const Window::Pixels& pixels) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(pixels.width);
  image.height = static_cast<png_uint_32>(pixels.height);
  image.format = PNG_FORMAT_RGB;
  png_alloc_size_t size = 0;
  if (png_image_write_to_memory(&image, nullptr, &size, 0, pixels.rgb.data(), 0, nullptr) == 0)
    throw InputError(std::string("panel: the picture cannot be made: ") + image.message);
  std::string bytes(size, '\0');
  if (png_image_write_to_memory(&image, bytes.data(), &size, 0, pixels.rgb.data(), 0, nullptr) == 0)
    throw InputError(std::string("panel: the picture cannot be made: ") + image.message);
  bytes.resize(size);
  return bytes;
}

}  // namespace handloop::ui
