#pragma once

#include <array>
#include <cstdint>

/// Colours and type. Everything that tells things apart does so in words, shape or place too; the colours are those of
/// Okabe and Ito (2008), which people with any colour vision can tell apart.
namespace handloop::ui {

struct Colour {
  float r = 0, g = 0, b = 0, a = 1;

  /// As ImGui packs it: alpha, blue, green, red from the highest byte.
  std::uint32_t packed() const;
  Colour faded(float alpha) const { return {r, g, b, alpha}; }
};

enum class Brightness { dark, light };

struct Palette {
  Brightness brightness = Brightness::dark;
  Colour window, surface, raised, line, text, muted;
  Colour accent;  ///< what is chosen or has the keyboard
  Colour stable, doubtful, unstable;
  Colour stop;                   ///< the stop button alone
  std::array<Colour, 7> series;  ///< curves, most important first
};
const Palette& palette_of(Brightness brightness);

/// Contrast ratio of WCAG 2 (1 to 21).
double contrast(const Colour& a, const Colour& b);
/// How the colour looks to a dichromat (Vienot, Brettel and Mollon 1999).
enum class ColourVision { normal, protanope, deuteranope };
Colour as_seen(const Colour& colour, ColourVision vision);

}  // namespace handloop::ui
