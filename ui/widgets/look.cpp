#include "ui/widgets/look.h"

#include <array>
#include <filesystem>

namespace handloop::ui {
namespace {

Look current;

constexpr std::array<const char*, 2> kBody{"/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf",
                                           "/usr/share/fonts/TTF/DejaVuSans.ttf"};
constexpr std::array<const char*, 2> kBold{"/usr/share/fonts/truetype/dejavu/DejaVuSans-Bold.ttf",
                                           "/usr/share/fonts/TTF/DejaVuSans-Bold.ttf"};

/// Latin with its supplement, and the few signs of the field.
constexpr std::array<ImWchar, 15> kGlyphs{0x20,   0xff,   0x391,  0x3c9,  0x2010, 0x2026, 0x221e, 0x221e,
                                          0x2260, 0x2265, 0x2190, 0x2193, 0x2264, 0x2265, 0};

/// DejaVu, or where it is not installed the font that ImGui brings, which knows Latin only.
ImFont* load(const std::array<const char*, 2>& files, float pixels) {
  auto& atlas = *ImGui::GetIO().Fonts;
  for (const char* file : files) {
    if (std::error_code missing; std::filesystem::exists(file, missing))
      return atlas.AddFontFromFileTTF(file, pixels, nullptr, kGlyphs.data());
  }
  ImFontConfig config;
  config.SizePixels = pixels;
  return atlas.AddFontDefault(&config);
}

void set_colours(const Palette& p) {
  auto& colours = ImGui::GetStyle().Colors;
  if (p.brightness == Brightness::dark) {
    ImGui::StyleColorsDark();
  } else {
    ImGui::StyleColorsLight();
  }
  const auto set = [&](ImGuiCol what, const Colour& colour) { colours[what] = vec(colour); };
  set(ImGuiCol_Text, p.text);
  set(ImGuiCol_TextDisabled, p.muted);
  set(ImGuiCol_WindowBg, p.window);
  set(ImGuiCol_ChildBg, p.surface);
  set(ImGuiCol_PopupBg, p.surface);
  set(ImGuiCol_Border, p.line);
  set(ImGuiCol_Separator, p.line);
  set(ImGuiCol_FrameBg, p.raised);
  set(ImGuiCol_FrameBgHovered, p.line);
  set(ImGuiCol_FrameBgActive, p.line);
  set(ImGuiCol_Button, p.raised);
  set(ImGuiCol_ButtonHovered, p.line);
  set(ImGuiCol_ButtonActive, p.accent.faded(0.6f));
  set(ImGuiCol_Header, p.raised);
  set(ImGuiCol_HeaderHovered, p.line);
  set(ImGuiCol_HeaderActive, p.accent.faded(0.4f));
  set(ImGuiCol_SliderGrab, p.accent.faded(0.55f));
  set(ImGuiCol_SliderGrabActive, p.accent.faded(0.75f));
  set(ImGuiCol_CheckMark, p.accent);
  set(ImGuiCol_NavHighlight, p.accent);
  set(ImGuiCol_PlotHistogram, p.accent);
  set(ImGuiCol_TextSelectedBg, p.accent.faded(0.35f));
  set(ImGuiCol_ScrollbarBg, p.surface);
  set(ImGuiCol_ScrollbarGrab, p.line);
  set(ImGuiCol_TitleBgActive, p.raised);
  set(ImGuiCol_ModalWindowDimBg, Colour{0, 0, 0, 0.4f});
}

}  // namespace

const Look& look() {
  return current;
}

void apply_look(Brightness brightness, float scale) {
  current.palette = &palette_of(brightness);
  if (current.body == nullptr || scale != current.scale) {
    ImGui::GetIO().Fonts->Clear();
    current.scale = scale;
    current.body = load(kBody, 14.0f * scale);
    current.small = load(kBody, 11.5f * scale);
    current.bold = load(kBold, 14.0f * scale);
    current.title = load(kBold, 24.0f * scale);
  }
  auto& style = ImGui::GetStyle();
  style = ImGuiStyle();
  style.WindowRounding = 0.0f;
  style.ChildRounding = style.PopupRounding = 5.0f;
  style.FrameRounding = style.GrabRounding = 3.0f;
  style.WindowPadding = {8, 8};
  style.FramePadding = {7, 3};
  style.ItemSpacing = {7, 5};
  style.ItemInnerSpacing = {5, 4};
  style.ScrollbarSize = 11.0f;
  style.GrabMinSize = 9.0f;
  style.ScaleAllSizes(scale);
  style.WindowBorderSize = 0.0f;
  style.ChildBorderSize = 1.0f;
  set_colours(*current.palette);
}

}  // namespace handloop::ui
