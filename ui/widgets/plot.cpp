#include "ui/widgets/plot.h"

#include <algorithm>
#include <cmath>

#include "ui/widgets/landmarks.h"
#include "ui/widgets/look.h"

namespace handloop::ui {
namespace {

constexpr float kFar = 20000.0f;  ///< beyond this a line's direction no longer matters

ImVec2 text_size(ImFont* font, const std::string& text) {
  return font->CalcTextSizeA(font->FontSize, 1e9f, 0.0f, text.c_str());
}

void write(ImDrawList* draw, ImFont* font, ImVec2 at, const Colour& colour, const std::string& text) {
  draw->AddText(font, font->FontSize, {std::round(at.x), std::round(at.y)}, packed(colour), text.c_str());
}

}  // namespace

Plot::Plot(Spec spec) : spec_(std::move(spec)), draw_(ImGui::GetWindowDrawList()) {
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  const ImVec2 size{std::max(spec_.size.x, px(120)), std::max(spec_.size.y, px(80))};
  ImGui::InvisibleButton(("##plot_" + spec_.id).c_str(), size);
  handloop::ui::mark("plot." + spec_.id);
  hovered_ = ImGui::IsItemHovered();
  clicked_ = ImGui::IsItemClicked(ImGuiMouseButton_Left);
  active_ = ImGui::IsItemActive();
  const float small = look().small->FontSize;
  low_ = {corner.x + px(46), corner.y + (spec_.title.empty() ? px(6) : look().bold->FontSize + px(7))};
  high_ = {corner.x + size.x - px(10), corner.y + size.y - small - px(7) - (spec_.x_label.empty() ? 0 : small + px(2))};
  if (spec_.round) {
    const double per_pixel = (spec_.x.high - spec_.x.low) / static_cast<double>(high_.x - low_.x);
    const double half = 0.5 * per_pixel * static_cast<double>(high_.y - low_.y);
    const double middle = 0.5 * (spec_.y.low + spec_.y.high);
    spec_.y = {middle - half, middle + half};
  }
  Landmarks::all().add("frame." + spec_.id, low_, high_);
  frame();
  draw_->PushClipRect(low_, high_, true);
}

Plot::~Plot() {
  draw_->PopClipRect();
  const bool keyboard = ImGui::IsItemFocused() && ImGui::GetIO().NavVisible;
  draw_->AddRect(low_, high_, packed(keyboard ? palette().accent : palette().line));
}

void Plot::frame() {
  const auto& p = palette();
  const float small = look().small->FontSize;
  draw_->AddRectFilled(low_, high_, packed(p.window));
  if (!spec_.title.empty())
    write(draw_, look().bold, {low_.x, low_.y - look().bold->FontSize - px(4)}, p.text, spec_.title);
  const float width = high_.x - low_.x, height = high_.y - low_.y;
  float last_label_end = -1e9f;
  for (const auto& tick : ticks_of(spec_.x, static_cast<int>(width / px(62)))) {
    const float x = at(tick.value, spec_.y.low).x;
    draw_->AddLine({x, low_.y}, {x, high_.y}, packed(p.line.faded(tick.label.empty() ? 0.25f : 0.6f)));
    const float half = 0.5f * text_size(look().small, tick.label).x;
    if (tick.label.empty() || x - half < last_label_end + px(4)) continue;
    write(draw_, look().small, {x - half, high_.y + px(3)}, p.muted, tick.label);
    last_label_end = x + half;
  }
  for (const auto& tick : ticks_of(spec_.y, static_cast<int>(height / px(30)))) {
    const float y = at(spec_.x.low, tick.value).y;
    draw_->AddLine({low_.x, y}, {high_.x, y}, packed(p.line.faded(tick.label.empty() ? 0.25f : 0.6f)));
    if (tick.label.empty()) continue;
    write(draw_, look().small, {low_.x - px(5) - text_size(look().small, tick.label).x, y - 0.5f * small}, p.muted,
          tick.label);
  }
  if (!spec_.x_label.empty()) {
    const float wide = text_size(look().small, spec_.x_label).x;
    write(draw_, look().small, {high_.x - wide, high_.y + small + px(4)}, p.muted, spec_.x_label);
  }
  if (!spec_.y_label.empty()) {
    const float wide = text_size(look().small, spec_.y_label).x;
    write(draw_, look().small, {high_.x - wide, low_.y - small - px(4)}, p.muted, spec_.y_label);
  }
}

ImVec2 Plot::at(double x, double y) const {
  const auto pixel = [](double place, float from, float length) {
    return std::isfinite(place) ? std::clamp(from + static_cast<float>(place) * length, -kFar, kFar) : NAN;
  };
  return {pixel(spec_.x.place_of(x), low_.x, high_.x - low_.x), pixel(spec_.y.place_of(y), high_.y, low_.y - high_.y)};
}

double Plot::x_at(float pixel) const {
  return spec_.x.value_at(static_cast<double>((pixel - low_.x) / (high_.x - low_.x)));
}

double Plot::y_at(float pixel) const {
  return spec_.y.value_at(static_cast<double>((high_.y - pixel) / (high_.y - low_.y)));
}

ImVec2 Plot::mouse() const {
  const auto& position = ImGui::GetIO().MousePos;
  return {std::clamp(position.x, low_.x, high_.x), std::clamp(position.y, low_.y, high_.y)};
}

void Plot::polyline(std::vector<ImVec2>& points, const Colour& colour, float width) {
  if (points.size() > 1)
    draw_->AddPolyline(points.data(), static_cast<int>(points.size()), packed(colour), ImDrawFlags_None, px(width));
  points.clear();
}

void Plot::line(std::span<const double> x, std::span<const double> y, const Colour& colour, float width) {
  std::vector<ImVec2> points;
  for (std::size_t i = 0; i < std::min(x.size(), y.size()); ++i) {
    const ImVec2 point = at(x[i], y[i]);
    if (std::isnan(point.x) || std::isnan(point.y)) {
      polyline(points, colour, width);
    } else if (points.empty() || std::abs(point.x - points.back().x) + std::abs(point.y - points.back().y) > 0.5f) {
      points.push_back(point);
    }
  }
  polyline(points, colour, width);
}

void Plot::dashed(std::span<const double> x, std::span<const double> y, const Colour& colour, float width) {
  const float dash = px(6);
  float way = 0;
  for (std::size_t i = 1; i < std::min(x.size(), y.size()); ++i) {
    const ImVec2 from = at(x[i - 1], y[i - 1]), to = at(x[i], y[i]);
    const float length = std::hypot(to.x - from.x, to.y - from.y);
    if (std::isnan(length) || length > kFar) continue;
    for (float done = 0; done < length;) {
      const float step = std::min(dash - std::fmod(way, dash) + 1e-3f, length - done);
      if (std::fmod(way, 2 * dash) < dash) {
        const auto place = [&](float t) { return ImVec2{from.x + (to.x - from.x) * t, from.y + (to.y - from.y) * t}; };
        draw_->AddLine(place(done / length), place((done + step) / length), packed(colour), px(width));
      }
      done += step;
      way += step;
    }
  }
}

void Plot::area(std::span<const double> x, std::span<const double> low, std::span<const double> high,
                const Colour& colour) {
  for (std::size_t i = 1; i < x.size(); ++i) {
    const ImVec2 a = at(x[i - 1], low[i - 1]), b = at(x[i - 1], high[i - 1]), c = at(x[i], high[i]),
                 d = at(x[i], low[i]);
    if (std::isnan(a.x + a.y + b.y + c.x + c.y + d.y)) continue;
    // without smoothed edges, which would show as seams
    const auto flags = draw_->Flags;
    draw_->Flags &= ~ImDrawListFlags_AntiAliasedFill;
    draw_->AddQuadFilled(a, b, c, d, packed(colour));
    draw_->Flags = flags;
  }
}

void Plot::bar(double x_low, double x_high, double y_low, double y_high, const Colour& colour) {
  const ImVec2 a = at(x_low, y_low), b = at(x_high, y_high);
  draw_->AddRectFilled({a.x, b.y}, {std::max(b.x - 1, a.x + 1), a.y}, packed(colour));
}

void Plot::mark(double x, double y, const Colour& colour, Mark shape, float radius) {
  const ImVec2 c = at(x, y);
  if (std::isnan(c.x) || std::isnan(c.y)) return;
  const float r = px(radius);
  switch (shape) {
    case Mark::dot:
      if (radius < 2.0f) {
        draw_->AddRectFilled({c.x - r, c.y - r}, {c.x + r, c.y + r}, packed(colour));
      } else {
        draw_->AddCircleFilled(c, r, packed(colour));
      }
      break;
    case Mark::ring:
      draw_->AddCircle(c, r, packed(colour), 0, px(2));
      break;
    case Mark::cross:
      draw_->AddLine({c.x - r, c.y - r}, {c.x + r, c.y + r}, packed(colour), px(2));
      draw_->AddLine({c.x - r, c.y + r}, {c.x + r, c.y - r}, packed(colour), px(2));
      break;
    case Mark::diamond:
      draw_->AddQuadFilled({c.x, c.y - r}, {c.x + r, c.y}, {c.x, c.y + r}, {c.x - r, c.y}, packed(colour));
      break;
  }
}

void Plot::vertical(double x, const Colour& colour, float width) {
  const float place = at(x, spec_.y.low).x;
  draw_->AddLine({place, low_.y}, {place, high_.y}, packed(colour), px(width));
}

void Plot::horizontal(double y, const Colour& colour, float width) {
  const float place = at(spec_.x.low, y).y;
  draw_->AddLine({low_.x, place}, {high_.x, place}, packed(colour), px(width));
}

void Plot::circle(double x, double y, double radius, const Colour& colour, bool filled, float width) {
  const ImVec2 centre = at(x, y);
  const float r = std::abs(at(x + radius, y).x - centre.x);
  if (filled) {
    draw_->AddCircleFilled(centre, r, packed(colour), 96);
  } else {
    draw_->AddCircle(centre, r, packed(colour), 96, px(width));
  }
}

void Plot::text(double x, double y, const std::string& text, const Colour& colour, ImVec2 offset) {
  const ImVec2 place = at(x, y);
  if (std::isnan(place.x) || std::isnan(place.y)) return;
  const ImVec2 size = text_size(look().small, text);
  ImVec2 corner{place.x + px(offset.x), place.y + px(offset.y)};
  corner.x = std::clamp(corner.x, low_.x + 2, std::max(low_.x + 2, high_.x - size.x - 2));
  corner.y = std::clamp(corner.y, low_.y + 1, std::max(low_.y + 1, high_.y - size.y - 1));
  draw_->AddRectFilled({corner.x - 2, corner.y}, {corner.x + size.x + 2, corner.y + size.y},
                       packed(palette().window.faded(0.7f)));
  write(draw_, look().small, corner, colour, text);
}

void Plot::legend(std::initializer_list<std::pair<const char*, Colour>> entries, bool lower_left) {
  float width = 0;
  for (const auto& entry : entries) width = std::max(width, text_size(look().small, entry.first).x);
  const float line = look().small->FontSize + px(3), height = line * static_cast<float>(entries.size());
  ImVec2 at{high_.x - width - px(28), low_.y + px(5)};
  if (lower_left) at = {low_.x + px(8), high_.y - height - px(5)};
  draw_->AddRectFilled({at.x - px(4), at.y - px(2)}, {at.x + width + px(24), at.y + height},
                       packed(palette().window.faded(0.75f)));
  for (const auto& [name, colour] : entries) {
    draw_->AddRectFilled({at.x, at.y + 0.4f * line}, {at.x + px(14), at.y + 0.4f * line + px(3)}, packed(colour));
    write(draw_, look().small, {at.x + px(20), at.y}, palette().text, name);
    at.y += line;
  }
}

void Plot::read_out(const std::string& text) {
  const ImVec2 size = text_size(look().small, text);
  const ImVec2 point = mouse();
  ImVec2 corner{point.x + px(12), point.y - size.y - px(8)};
  corner.x = std::min(corner.x, high_.x - size.x - px(6));
  corner.y = std::max(corner.y, low_.y + px(4));
  draw_->AddRectFilled({corner.x - px(4), corner.y - px(2)}, {corner.x + size.x + px(4), corner.y + size.y + px(2)},
                       packed(palette().raised), px(3));
  write(draw_, look().small, corner, palette().text, text);
}

AxisRange range_of(std::span<const double> values, double least) {
  double low = INFINITY, high = -INFINITY;
  for (const double value : values) {
    if (std::isfinite(value)) low = std::min(low, value), high = std::max(high, value);
  }
  if (low > high) return {-least, least};
  const double room = std::max(0.06 * (high - low), 0.5 * (least - (high - low)));
  return {low - std::max(room, 0.5 * least * 0.1), high + std::max(room, 0.5 * least * 0.1)};
}

}  // namespace handloop::ui
