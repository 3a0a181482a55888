#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstring>

#include "io/gnuplot.h"
#include "io/html_text.h"

namespace handloop::io::detail {
namespace {

/// Reads "rgb( 1, 2, 3)" at the position; length 0 where there is none.
std::size_t read_rgb(std::string_view text, std::array<int, 3>& value) {
  constexpr std::string_view kStart = "rgb(";
  if (!text.starts_with(kStart)) return 0;
  std::size_t at = kStart.size();
  for (std::size_t i = 0; i < 3; ++i) {
    while (at < text.size() && text[at] == ' ') ++at;
    const auto [end, error] = std::from_chars(text.data() + at, text.data() + text.size(), value[i]);
    if (error != std::errc()) return 0;
    at = static_cast<std::size_t>(end - text.data());
    while (at < text.size() && text[at] == ' ') ++at;
    if (at >= text.size() || text[at] != (i < 2 ? ',' : ')')) return 0;
    ++at;
  }
  return at;
}

std::string variable(std::array<int, 3> value) {
  const auto fallback = fmt::format("#{:02x}{:02x}{:02x}", value[0], value[1], value[2]);
  for (const auto& colour : theme_colours()) {
    if (value == std::array{colour.red, colour.green, colour.blue})
      return fmt::format("var(--hl-{},{})", colour.variable, fallback);
  }
  return fallback;
}

/// Removes everything from `begin` to `end` inclusive, as often as it occurs.
void erase_between(std::string& text, std::string_view begin, std::string_view end) {
  for (auto at = text.find(begin); at != std::string::npos; at = text.find(begin, at)) {
    const auto stop = text.find(end, at + begin.size());
    if (stop == std::string::npos) return;
    text.erase(at, stop + end.size() - at);
  }
}

}  // namespace

std::string adapt_svg(const std::string& svg, const std::string& prefix, const std::string& title) {
  auto body = svg.substr(std::min(svg.find("<svg"), svg.size()));
  erase_between(body, "<desc>", "</desc>\n");
  erase_between(body, "<filter", "</filter>\n");
  const auto head_end = body.find('>');
  const auto old_title = body.find("<title>Gnuplot</title>");
  if (old_title != std::string::npos)
    body.replace(old_title, std::strlen("<title>Gnuplot</title>"),
                 fmt::format("<title>{}</title>", escape_html(title)));
  if (head_end != std::string::npos) body.insert(head_end, " role=\"img\"");

  std::string adapted;
  adapted.reserve(body.size());
  for (std::size_t i = 0; i < body.size();) {
    const std::string_view rest = std::string_view(body).substr(i);
    std::array<int, 3> value{};
    if (const auto length = rest[0] == 'r' ? read_rgb(rest, value) : 0; length > 0) {
      adapted += variable(value);
      i += length;
    } else if (rest.starts_with("color=\"black\"")) {
      adapted += "color=\"var(--hl-ink,#1f2937)\"";
      i += std::strlen("color=\"black\"");
    } else if (rest.starts_with("id='gp") || rest.starts_with("id=\"gnuplot") || rest.starts_with("'#gp")) {
      const std::size_t lead = rest.starts_with("'#gp") ? 2 : 4;
      adapted += rest.substr(0, lead);
      adapted += prefix;
      i += lead;
    } else if (rest[0] == '<' && rest.starts_with("<g ")) {
      // Groups that hold nothing are a third of gnuplot's output.
      const auto close = rest.find('>');
      if (close != std::string_view::npos && rest.substr(close + 1).starts_with("\n</g>\n")) {
        i += close + 1 + std::strlen("\n</g>\n");
      } else {
        adapted += rest[0];
        ++i;
      }
    } else {
      adapted += rest[0];
      ++i;
    }
  }
  return adapted;
}

}  // namespace handloop::io::detail
