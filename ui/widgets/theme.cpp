#include "ui/widgets/theme.h"

#include <algorithm>
#include <cmath>

namespace handloop::ui {
namespace {

constexpr Colour hex(std::uint32_t rgb) {
  return {static_cast<float>((rgb >> 16) & 255u) / 255.0f, static_cast<float>((rgb >> 8) & 255u) / 255.0f,
          static_cast<float>(rgb & 255u) / 255.0f, 1.0f};
}

const Palette kDark{
    Brightness::dark,
    hex(0x12161b),
    hex(0x1a2027),
    hex(0x28313c),
    hex(0x3a4653),
    hex(0xe8edf2),
    hex(0xa0adba),
    hex(0x56b4e9),
    hex(0x56b4e9),
    hex(0xf0c419),
    hex(0xff7a45),
    hex(0xd1331b),
    {hex(0x56b4e9), hex(0xe69f00), hex(0x1fc48f), hex(0xe08cbb), hex(0xf0e442), hex(0xff7a45), hex(0xc3ccd6)}};
const Palette kLight{
    Brightness::light,
    hex(0xeef1f4),
    hex(0xffffff),
    hex(0xdfe5eb),
    hex(0xbcc6d0),
    hex(0x17202a),
    hex(0x55626f),
    hex(0x0072b2),
    hex(0x0072b2),
    hex(0x8a6100),
    hex(0xb84300),
    hex(0xc0200c),
    {hex(0x0072b2), hex(0xb97a00), hex(0x00805c), hex(0xa8487f), hex(0x7d7500), hex(0xb84300), hex(0x4a5560)}};

double linear(float channel) {
  const double c = static_cast<double>(channel);
  return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}

float encoded(double c) {
  c = std::clamp(c, 0.0, 1.0);
  return static_cast<float>(c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1 / 2.4) - 0.055);
}

double luminance(const Colour& c) {
  return 0.2126 * linear(c.r) + 0.7152 * linear(c.g) + 0.0722 * linear(c.b);
}

}  // namespace

std::uint32_t Colour::packed() const {
  const auto byte = [](float x) { return static_cast<std::uint32_t>(std::lround(255.0f * std::clamp(x, 0.0f, 1.0f))); };
  return byte(a) << 24 | byte(b) << 16 | byte(g) << 8 | byte(r);
}

const Palette& palette_of(Brightness brightness) {
  return brightness == Brightness::dark ? kDark : kLight;
}

double contrast(const Colour& a, const Colour& b) {
  const double first = luminance(a), second = luminance(b);
  return (std::max(first, second) + 0.05) / (std::min(first, second) + 0.05);
}

Colour as_seen(const Colour& colour, ColourVision vision) {
  const double r = linear(colour.r), g = linear(colour.g), b = linear(colour.b);
  if (vision == ColourVision::protanope) {
    const double rg = 0.11238 * r + 0.88762 * g;
    return {encoded(rg), encoded(rg), encoded(0.00401 * r - 0.00401 * g + b), colour.a};
  }
  if (vision == ColourVision::deuteranope) {
    const double rg = 0.29275 * r + 0.70725 * g;
    return {encoded(rg), encoded(rg), encoded(-0.02234 * r + 0.02234 * g + b), colour.a};
  }
  return colour;
}

}  // namespace handloop::ui
