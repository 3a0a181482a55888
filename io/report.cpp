#include "io/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "io/csv_file.h"
#include "io/gnuplot.h"
#include "io/html_text.h"
#include "io/output.h"

namespace handloop::io {
namespace {

constexpr const char* kStyle = R"css(
:root{color-scheme:light dark;--paper:#fff;--card:#f6f8fa;--line:#dde2e8;--text:#1f2937;--soft:#5b6673;--accent:#0072b2;
--good:#00795a;--good-bg:#e6f5f0;--warn:#9a4a00;--warn-bg:#fdf0e4;--idea:#8a4a76;--idea-bg:#faeff6;--note-bg:#eaf3fa;LIGHT}
@media(prefers-color-scheme:dark){:root{--paper:#0f1318;--card:#171c23;--line:#2b323b;--text:#d8dee6;--soft:#98a2ae;
--accent:#6bb8ee;--good:#2fc79b;--good-bg:#10261f;--warn:#ffab70;--warn-bg:#2c1d10;--idea:#e6a0c8;--idea-bg:#29182a;--note-bg:#12222f;DARK}}
*{box-sizing:border-box}
html{scroll-behavior:smooth}
body{margin:0;background:var(--paper);color:var(--text);font:16px/1.6 system-ui,-apple-system,"Segoe UI",Roboto,"Noto Sans",sans-serif;
-webkit-text-size-adjust:100%}
main{max-width:1080px;margin:0 auto;padding:40px 24px 64px}
h1{font-size:1.9rem;line-height:1.2;margin:0 0 4px;letter-spacing:-.01em}
h2{font-size:1.35rem;line-height:1.3;margin:44px 0 10px;padding-top:14px;border-top:1px solid var(--line)}
h3{font-size:1.08rem;margin:26px 0 6px}
p,ul{margin:8px 0 12px;max-width:76ch}
ul{padding-left:1.3em}
.sub{color:var(--soft);font-size:1.05rem;margin:0 0 8px}
a{color:var(--accent)}
code,pre{font:.88em/1.5 ui-monospace,SFMono-Regular,Menlo,"DejaVu Sans Mono",monospace;background:var(--card);border-radius:5px}
code{padding:.1em .35em}
pre{padding:12px 16px;overflow-x:auto;white-space:pre-wrap;border:1px solid var(--line)}
nav{display:flex;flex-wrap:wrap;gap:6px 18px;margin:18px 0 0;font-size:.92rem}
nav a{text-decoration:none}nav a:hover{text-decoration:underline}
.figures{display:grid;grid-template-columns:repeat(auto-fit,minmax(170px,1fr));gap:12px;margin:18px 0}
.figure{background:var(--card);border:1px solid var(--line);border-left:4px solid var(--line);border-radius:8px;padding:12px 14px}
.figure.good{border-left-color:var(--good)}.figure.bad{border-left-color:var(--warn)}
.figure .label{color:var(--soft);font-size:.86rem}.figure .value{font-size:1.45rem;font-weight:600;line-height:1.25;font-variant-numeric:tabular-nums;overflow-wrap:anywhere}
.figure .note{color:var(--soft);font-size:.84rem}
.callout{border-left:4px solid var(--accent);background:var(--note-bg);border-radius:0 8px 8px 0;padding:10px 16px;margin:14px 0;max-width:82ch}
.callout b{display:block;font-size:.8rem;letter-spacing:.04em;text-transform:uppercase;color:var(--accent)}
.callout.good{border-color:var(--good);background:var(--good-bg)}.callout.good b{color:var(--good)}
.callout.warning{border-color:var(--warn);background:var(--warn-bg)}.callout.warning b{color:var(--warn)}
.callout.assumption{border-color:var(--idea);background:var(--idea-bg)}.callout.assumption b{color:var(--idea)}
.scroll{overflow-x:auto;margin:14px 0 18px}
table{border-collapse:collapse;font-size:.93rem;font-variant-numeric:tabular-nums}
caption{caption-side:bottom;text-align:left;color:var(--soft);font-size:.88rem;padding-top:6px}
th,td{padding:5px 14px 5px 0;text-align:left;border-bottom:1px solid var(--line);vertical-align:top}
th{font-weight:600;color:var(--soft);border-bottom:2px solid var(--line);white-space:nowrap}
td.n,th.n{text-align:right;white-space:nowrap}
tbody tr:hover{background:var(--card)}
figure{margin:16px 0 20px}
figcaption{color:var(--soft);font-size:.9rem;max-width:86ch;margin-top:2px}
.plots{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(100%,460px),1fr));gap:10px 22px}
.plots.one{display:block}
.plot h4{margin:0 0 2px;font-size:.98rem}
.plot svg{width:100%;height:auto;display:block}
.plots.one .plot svg{max-width:900px}
svg text{font-family:system-ui,-apple-system,"Segoe UI",Roboto,"Noto Sans",sans-serif}
footer{margin-top:48px;padding-top:12px;border-top:1px solid var(--line);color:var(--soft);font-size:.86rem}
@media print{:root{color-scheme:light}main{max-width:none;padding:0}h2{break-after:avoid}figure,.figure,tr{break-inside:avoid}nav{display:none}}
)css";

std::string style() {
  std::string css = kStyle, light, dark;
  for (const auto& colour : detail::theme_colours()) {
    light += fmt::format("--hl-{}:#{:02x}{:02x}{:02x};", colour.variable, colour.red, colour.green, colour.blue);
    dark += fmt::format("--hl-{}:{};", colour.variable, colour.dark);
  }
  css.replace(css.find("LIGHT"), 5, light);
  css.replace(css.find("DARK"), 4, dark);
  return css;
}

/// An anchor made of a heading's letters.
std::string anchor(std::string_view heading) {
  std::string id;
  for (const char c : heading) {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0) {
      id += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    } else if (!id.empty() && id.back() != '-') {
      id += '-';
    }
  }
  while (!id.empty() && id.back() == '-') id.pop_back();
  return id.empty() ? "section" : id;
}

/// True for what should stand right-aligned: a number, perhaps with a unit or sign around it.
bool looks_like_number(std::string_view cell) {
  if (cell.empty() || cell == "–" || cell == "∞" || cell == "-") return true;
  for (const std::string_view sign : {"−", "≤", "≥", "<", ">", "±", "×"}) {
    if (cell.starts_with(sign)) cell.remove_prefix(sign.size());
  }
  while (cell.starts_with(' ')) cell.remove_prefix(1);
  auto number = cell.substr(0, cell.find(' '));
  while (!number.empty() && (number.back() == '%' || number.back() == ',')) number.remove_suffix(1);
  return parse_number(number).has_value();
}

}  // namespace

Report::Report(std::string title, std::string subtitle) : title_(std::move(title)), subtitle_(std::move(subtitle)) {}

Report& Report::add(std::string html) {
  pieces_.push_back({std::move(html), -1});
  return *this;
}

Report& Report::section(std::string_view heading) {
  auto id = anchor(heading);
  const auto taken =
      std::count_if(sections_.begin(), sections_.end(), [&](const auto& s) { return s.id.starts_with(id); });
  if (taken > 0) id += fmt::format("-{}", taken + 1);
  sections_.push_back({std::string(heading), id});
  return add(fmt::format("<h2 id=\"{}\">{}</h2>\n", id, markup_to_html(heading)));
}

Report& Report::subsection(std::string_view heading) {
  return add(fmt::format("<h3>{}</h3>\n", markup_to_html(heading)));
}

Report& Report::paragraph(std::string_view text) {
  return add(fmt::format("<p>{}</p>\n", markup_to_html(text)));
}

Report& Report::list(const std::vector<std::string>& items) {
  std::string html = "<ul>\n";
  for (const auto& item : items) html += fmt::format("<li>{}</li>\n", markup_to_html(item));
  return add(html + "</ul>\n");
}

Report& Report::callout(Tone tone, std::string_view text) {
  constexpr const char* kWords[] = {"Note", "Good", "Mind", "Assumption"};
  constexpr const char* kClasses[] = {"note", "good", "warning", "assumption"};
  const auto index = static_cast<std::size_t>(tone);
  return add(fmt::format("<div class=\"callout {}\"><b>{}</b>{}</div>\n", kClasses[index], kWords[index],
                         markup_to_html(text)));
}

Report& Report::figures(const std::vector<Figure>& figures) {
  constexpr const char* kMoods[] = {"", " good", " bad"};
  std::string html = "<div class=\"figures\">\n";
  for (const auto& figure : figures) {
    html += fmt::format(
        "<div class=\"figure{}\"><div class=\"label\">{}</div><div class=\"value\">{}</div><div "
        "class=\"note\">{}</div></div>\n",
        kMoods[static_cast<std::size_t>(figure.mood)], markup_to_html(figure.label), markup_to_html(figure.value),
        markup_to_html(figure.note));
  }
  return add(html + "</div>\n");
}

Report& Report::table(const Table& table) {
  std::vector<bool> numeric(table.columns.size(), !table.rows.empty());
  for (const auto& row : table.rows) {
    for (std::size_t i = 0; i < row.size() && i < numeric.size(); ++i)
      numeric[i] = numeric[i] && looks_like_number(row[i]);
  }
  const auto cell = [&](const char* tag, std::size_t column, const std::string& text) {
    const bool right = column < numeric.size() && numeric[column];
    return fmt::format("<{0}{1}>{2}</{0}>", tag, right ? " class=\"n\"" : "", markup_to_html(text));
  };
  std::string html = "<div class=\"scroll\"><table>\n";
  if (!table.caption.empty()) html += fmt::format("<caption>{}</caption>\n", markup_to_html(table.caption));
  html += "<thead><tr>";
  for (std::size_t i = 0; i < table.columns.size(); ++i) html += cell("th", i, table.columns[i]);
  html += "</tr></thead>\n<tbody>\n";
  for (const auto& row : table.rows) {
    html += "<tr>";
    for (std::size_t i = 0; i < row.size(); ++i) html += cell("td", i, row[i]);
    html += "</tr>\n";
  }
  return add(html + "</tbody></table></div>\n");
}

Report& Report::plot(Plot plot, std::string_view caption) {
  std::vector<Plot> one;
  one.push_back(std::move(plot));
  return plots(std::move(one), caption);
}

Report& Report::plots(std::vector<Plot> plots, std::string_view caption) {
  add(fmt::format("<figure><div class=\"plots{}\">\n", plots.size() == 1 ? " one" : ""));
  for (auto& plot : plots) {
    if (plots.size() > 1 && plot.width_px == Plot().width_px) {  // drawn as small as it is shown: words keep their size
      plot.width_px = 510;
      if (plot.height_px == Plot().height_px) plot.height_px = 320;
    }
    const auto heading = plot.title.empty() ? std::string() : fmt::format("<h4>{}</h4>", markup_to_html(plot.title));
    pieces_.push_back({fmt::format("<div class=\"plot\">{}", heading), static_cast<int>(plots_.size())});
    plots_.push_back(std::move(plot));
    add("</div>\n");
  }
  add("</div>");
  if (!caption.empty()) add(fmt::format("<figcaption>{}</figcaption>", markup_to_html(caption)));
  return add("</figure>\n");
}

Report& Report::code(std::string_view text) {
  return add(fmt::format("<pre>{}</pre>\n", escape_html(text)));
}

Report& Report::html(std::string_view html) {
  return add(std::string(html));
}

std::string Report::to_html() const {
  const auto drawn = draw_svg(plots_);
  std::string page = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, "
      "initial-scale=1\">\n<title>{0}</title>\n<style>{1}</style>\n</head>\n"
      "<body>\n<main>\n<h1>{0}</h1>\n",
      escape_html(title_), style());
  if (!subtitle_.empty()) page += fmt::format("<p class=\"sub\">{}</p>\n", markup_to_html(subtitle_));
  if (sections_.size() > 2) {
    page += "<nav>";
    for (const auto& section : sections_)
      page += fmt::format("<a href=\"#{}\">{}</a>\n", section.id, markup_to_html(section.heading));
    page += "</nav>\n";
  }
  for (const auto& piece : pieces_) {
    page += piece.html;
    if (piece.plot >= 0) page += drawn[static_cast<std::size_t>(piece.plot)];
  }
  return page +
         "<footer>Made by handloop. Everything on this page is in this one file.</footer>\n</main>\n</body>\n</html>\n";
}

void Report::write(const std::filesystem::path& path) const {
  write_file_atomically(path, to_html());
}

std::string pretty(double value, int digits) {
  if (std::isnan(value)) return "–";
  if (std::isinf(value)) return value > 0 ? "∞" : "−∞";
  return fmt::format("{:.{}g}", value, digits);
}

}  // namespace handloop::io
