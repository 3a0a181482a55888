#include "io/html_text.h"

namespace handloop::io {

std::string escape_html(std::string_view text) {
  std::string escaped;
  escaped.reserve(text.size() + text.size() / 8);
  for (const char c : text) {
    switch (c) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      case '\'':
        escaped += "&#39;";
        break;
      default:
        escaped += static_cast<unsigned char>(c) < 0x20 && c != '\n' ? ' ' : c;
    }
  }
  return escaped;
}

std::string markup_to_html(std::string_view text) {
  std::string html;
  while (!text.empty()) {
    // The content between a mark and its twin, where there is one.
    const auto enclosed = [&](std::string_view mark) -> std::string_view {
      if (!text.starts_with(mark)) return {};
      const auto end = text.find(mark, mark.size());
      return end == std::string_view::npos ? std::string_view() : text.substr(mark.size(), end - mark.size());
    };
    if (const auto code = enclosed("`"); !code.empty()) {
      html += "<code>" + escape_html(code) + "</code>";
      text.remove_prefix(code.size() + 2);
      continue;
    }
    if (const auto strong = enclosed("**"); !strong.empty()) {
      html += "<strong>" + escape_html(strong) + "</strong>";
      text.remove_prefix(strong.size() + 4);
      continue;
    }
    if (text.starts_with('[')) {
      const auto middle = text.find("](");
      const auto end = middle == std::string_view::npos ? middle : text.find(')', middle);
      const auto target =
          end == std::string_view::npos ? std::string_view() : text.substr(middle + 2, end - middle - 2);
      if (target.starts_with("#") || target.starts_with("https://")) {
        html += "<a href=\"" + escape_html(target) + "\">" + escape_html(text.substr(1, middle - 1)) + "</a>";
        text.remove_prefix(end + 1);
        continue;
      }
    }
    html += escape_html(text.substr(0, 1));
    text.remove_prefix(1);
  }
  return html;
}

}  // namespace handloop::io
