#include "io/gnuplot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

namespace handloop::io::detail {
namespace {

using Style = Series::Style;

constexpr ThemeColour kColours[] = {
    // In the order of Colour; Okabe and Ito's palette, lighter in the dark.
    {"blue", 0, 114, 178, "#4aa8e8"},   {"blue", 0, 114, 178, "#4aa8e8"},     {"orange", 213, 94, 0, "#ff8b42"},
    {"green", 0, 158, 115, "#2fc79b"},  {"purple", 204, 121, 167, "#e6a0c8"}, {"amber", 230, 159, 0, "#ffc34d"},
    {"sky", 86, 180, 233, "#8fd0f7"},   {"grey", 125, 133, 143, "#8b949e"},   {"ink", 31, 41, 55, "#d8dee6"},
    {"grid", 222, 226, 231, "#30363d"},
};
constexpr Colour kTurn[] = {Colour::blue, Colour::orange, Colour::green, Colour::purple, Colour::amber, Colour::sky};

std::string rgb(const ThemeColour& colour) {
  return fmt::format("rgb '#{:02x}{:02x}{:02x}'", colour.red, colour.green, colour.blue);
}

std::string rgb(Colour colour) {
  return rgb(theme_colour(colour));
}

/// A gnuplot string; nothing in it is special.
std::string text(std::string_view content) {
  std::string quoted = "'";
  for (const char c : content) {
    if (c == '\'') quoted += '\'';
    quoted += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
  }
  return quoted + "'";
}

class Script {
 public:
  explicit Script(const Plot& plot) : plot_(plot) {}

  std::string build(const std::filesystem::path& output) {
    add("reset");
    add(fmt::format("set terminal svg size {:.0f},{:.0f} dynamic noenhanced font 'sans-serif,13' lw 1", plot_.width_px,
                    plot_.height_px));
    add("set output " + text(output.string()));
    frame();
    for (const auto& mark : plot_.vertical) add_mark(mark, true);
    for (const auto& mark : plot_.horizontal) add_mark(mark, false);
    for (const auto& note : plot_.annotations) {
      add(fmt::format("set label {} at {:.9g},{:.9g} left front offset 0.6,0.3 tc {}", text(note.text), note.x, note.y,
                      rgb(Colour::ink)));
    }
    if (plot_.heat_map) add_heat_map(*plot_.heat_map);
    std::size_t turn = 0;
    for (const auto& series : plot_.series) {
      const auto colour = series.colour != Colour::automatic ? series.colour : kTurn[turn++ % std::size(kTurn)];
      add_series(series, colour);
    }
    if (!any_data_) {  // a frame all the same; without a range there would be an error
      if (!plot_.x_range) add(plot_.log_x ? "set xrange [1:10]" : "set xrange [0:1]");
      if (!plot_.y_range) add(plot_.log_y ? "set yrange [1:10]" : "set yrange [0:1]");
    }
    if (items_.empty()) items_.push_back("NaN notitle");
    commands_ += "plot ";
    for (std::size_t i = 0; i < items_.size(); ++i) commands_ += (i > 0 ? ", \\\n  " : "") + items_[i];
    add("");
    add("unset output");
    return blocks_ + commands_;
  }

 private:
  const Plot& plot_;
  std::string blocks_;  ///< data, before the commands that use them
  std::string commands_;
  std::vector<std::string> items_;
  int block_count_ = 0;
  int mark_count_ = 0;
  bool any_data_ = false;

  void add(const std::string& line) { commands_ += line + "\n"; }

  void frame() {
    add(fmt::format("set border 3 lc {} lw 1", rgb(Colour::grey)));
    add(fmt::format("set tics nomirror out scale 0.5 tc {}", rgb(Colour::ink)));
    if (!plot_.heat_map) add(fmt::format("set grid back lt 1 lc {} lw 1", rgb(kColours[9])));
    // Beside a plot of equal axes, which leaves room there; above any other.
    add(fmt::format("set key {} samplen 1.6 spacing 1.15 height 0.3 tc {}",
                    plot_.equal_axes ? "outside right top vertical Left reverse" : "above left horizontal Left reverse",
                    rgb(Colour::ink)));
    // Room for a last tick's label and for a word at a line near the right end.
    add(plot_.heat_map ? "set rmargin 10" : "set rmargin 3");
    const auto label = [&](const char* axis, const std::string& words) {
      if (!words.empty()) add(fmt::format("set {}label {} tc {}", axis, text(words), rgb(Colour::ink)));
    };
    add("set autoscale xfix");
    label("x", plot_.x_label);
    label("y", plot_.y_label);
    if (plot_.log_x) add("set logscale x; set format x '%g'; set mxtics 10");
    if (plot_.log_y) add("set logscale y; set format y '%g'");
    if (plot_.x_range) add(fmt::format("set xrange [{:.9g}:{:.9g}]", (*plot_.x_range)[0], (*plot_.x_range)[1]));
    if (plot_.y_range) {
      const auto [low, high] = *plot_.y_range;
      add(fmt::format("set yrange [{:.9g}:{:.9g}]", plot_.reverse_y ? high : low, plot_.reverse_y ? low : high));
    } else if (plot_.reverse_y) {
      add("set yrange [*:*] reverse");
    }
    if (plot_.log_x) log_tics("x", x_extent());
    if (plot_.log_y && plot_.y_range) log_tics("y", *plot_.y_range);
    categories("x", plot_.x_categories);
    categories("y", plot_.y_categories);
    if (plot_.equal_axes) add("set size ratio -1");
  }

  void categories(const char* axis, const std::vector<std::string>& names) {
    if (names.empty()) return;
    std::string tics;
    for (std::size_t i = 0; i < names.size(); ++i) {
      std::string name;  // names of tics are formats: a percent sign is written twice
      for (const char c : names[i]) name += c == '%' ? std::string("%%") : std::string(1, c);
      tics += fmt::format("{}{} {}", i > 0 ? ", " : "", text(name), i + 1);
    }
    add(fmt::format("set {}tics ({})", axis, tics));
    const double low = 0.4, high = static_cast<double>(names.size()) + 0.6;
    if (axis[0] == 'x' && !plot_.x_range) add(fmt::format("set xrange [{}:{}]", low, high));
    if (axis[0] == 'y' && !plot_.y_range) {
      add(fmt::format("set yrange [{}:{}]", plot_.reverse_y ? high : low, plot_.reverse_y ? low : high));
    }
  }

  /// What the horizontal axis spans: as asked, or as the data do.
  std::array<double, 2> x_extent() const {
    if (plot_.x_range) return *plot_.x_range;
    std::array extent{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
    const auto include = [&](const std::vector<double>& values) {
      for (const double value : values) {
        if (std::isnan(shown(value, plot_.log_x))) continue;
        extent = {std::min(extent[0], value), std::max(extent[1], value)};
      }
    };
    for (const auto& series : plot_.series) {
      include(series.x);
      if (series.style == Style::bars) {
        include(series.lower);
        include(series.upper);
      }
    }
    if (plot_.heat_map) include(plot_.heat_map->x);
    return extent;
  }

  /// Over few decades the powers of ten are too few to read a value by: 1, 2 and 5 of each are named.
  void log_tics(const char* axis, std::array<double, 2> extent) {
    if (!(extent[0] > 0 && extent[1] > extent[0]) || extent[1] / extent[0] > 500) return;
    std::string tics;
    for (double decade = std::pow(10, std::floor(std::log10(extent[0]))); decade <= extent[1]; decade *= 10) {
      for (const double step : {1.0, 2.0, 5.0})
        tics += fmt::format("{}{:.6g}", tics.empty() ? "" : ", ", step * decade);
    }
    add(fmt::format("set {}tics ({})", axis, tics));
  }

  void add_mark(const Mark& mark, bool vertical) {
    if (!std::isfinite(mark.at)) return;
    const auto from =
        vertical ? fmt::format("{:.9g}, graph 0", mark.at) : fmt::format("graph 0, first {:.9g}", mark.at);
    const auto to = vertical ? fmt::format("{:.9g}, graph 1", mark.at) : fmt::format("graph 1, first {:.9g}", mark.at);
    add(fmt::format("set arrow from {} to {} nohead lc {} lw 1.2 {}", from, to, rgb(mark.colour),
                    mark.dashed ? "dt 2" : ""));
    if (mark.label.empty()) return;
    // Words of neighbouring lines stand at different heights.
    const double height = 0.95 - 0.075 * (mark_count_++ % 4);
    if (vertical) {
      const auto [low, high] = x_extent();
      const double share =
          plot_.log_x ? std::log(mark.at / low) / std::log(high / low) : (mark.at - low) / (high - low);
      const bool at_right = share > 0.66;  // its words would run out of the frame
      add(fmt::format("set label {} at first {:.9g}, graph {} {} front offset {},0 tc {}", text(mark.label), mark.at,
                      height, at_right ? "right" : "left", at_right ? -0.5 : 0.5, rgb(mark.colour)));
    } else {
      add(fmt::format("set label {} at graph 0.99, first {:.9g} right front offset 0,0.5 tc {}", text(mark.label),
                      mark.at, rgb(mark.colour)));
    }
  }

  /// Starts a block of data; the name refers to it in `plot`.
  std::string begin_block() {
    const auto name = fmt::format("$d{}", block_count_++);
    blocks_ += name + " << END\n";
    return name;
  }

  double shown(double value, bool logarithmic) const {
    return std::isfinite(value) && (!logarithmic || value > 0) ? value : std::numeric_limits<double>::quiet_NaN();
  }

  /// Rows of columns; a row with a gap in it becomes an empty line, which breaks lines.
  std::string block(std::initializer_list<std::pair<const std::vector<double>*, bool>> columns) {
    const auto name = begin_block();
    std::size_t rows = std::numeric_limits<std::size_t>::max();
    for (const auto& [column, logarithmic] : columns) rows = std::min(rows, column->size());
    for (std::size_t row = 0; row < rows; ++row) {
      std::string line;
      for (const auto& [column, logarithmic] : columns) {
        const double value = shown((*column)[row], logarithmic);
        if (std::isnan(value)) {
          line.clear();
          break;
        }
        line += fmt::format("{:.7g} ", value);
      }
      any_data_ = any_data_ || !line.empty();
      blocks_ += line + "\n";
    }
    if (rows == 0) blocks_ += "\n";
    blocks_ += "END\n";
    return name;
  }

  void add_series(const Series& series, Colour colour) {
    const auto title = series.label.empty() ? std::string("notitle") : "title " + text(series.label);
    const auto dash = series.dashed ? " dt 2" : "";
    const auto line = fmt::format("lc {} lw {:.3g}{}", rgb(colour), series.width, dash);
    const auto opacity = [&](double usual) { return series.opacity > 0 ? series.opacity : usual; };
    const auto log_x = plot_.log_x, log_y = plot_.log_y;
    auto x = series.x, y = series.y;
    switch (series.style) {
      case Style::line:
      case Style::steps: {
        thin(x, y, log_x);
        const auto name = block({{&x, log_x}, {&y, log_y}});
        items_.push_back(fmt::format("{} using 1:2 with {} {} {}", name,
                                     series.style == Style::line ? "lines" : "steps", line, title));
        break;
      }
      case Style::points:
      case Style::line_points: {
        thin(x, y, log_x, series.style == Style::points ? 1500 : 700);
        const auto name = block({{&x, log_x}, {&y, log_y}});
        if (plot_.heat_map) items_.push_back(name + " using 1:2 with points pt 7 ps 0.9 lc rgb '#ffffff' notitle");
        items_.push_back(fmt::format("{} using 1:2 with {} pt 7 ps {} {} {}", name,
                                     series.style == Style::points ? "points" : "linespoints",
                                     x.size() > 200 ? 0.25 : 0.45, line, title));
        break;
      }
      case Style::band: {
        const auto name = block({{&series.x, log_x}, {&series.lower, log_y}, {&series.upper, log_y}});
        items_.push_back(fmt::format("{} using 1:2:3 with filledcurves fs transparent solid {:.3g} noborder fc {} {}",
                                     name, opacity(0.22), rgb(colour), title));
        break;
      }
      case Style::intervals: {
        const auto name = block({{&x, log_x}, {&y, log_y}, {&series.lower, log_y}, {&series.upper, log_y}});
        items_.push_back(fmt::format("{} using 1:2:3:4 with yerrorbars pt 7 ps 0.5 {} {}", name, line, title));
        break;
      }
      case Style::bars: {
        const auto name = block({{&series.lower, log_x}, {&series.upper, log_x}, {&y, log_y}});
        const auto foot = log_y ? "1e-300" : "0";
        items_.push_back(fmt::format(
            "{0} using (($1+$2)/2):3:1:2:({4}):3 with boxxyerror fs transparent solid {1:.3g} border lc {2} fc {2} {3}",
            name, opacity(0.35), rgb(colour), title, foot));
        break;
      }
      case Style::horizontal_bars: {
        const auto name = block({{&x, log_x}, {&y, log_y}});
        items_.push_back(
            fmt::format("{0} using 1:2:(0):1:($2-0.32):($2+0.32) with boxxyerror fs transparent solid {1:.3g} border "
                        "lc {2} fc {2} {3}",
                        name, opacity(0.5), rgb(colour), title));
        break;
      }
      case Style::fan: {
        const auto name = block({{&x, log_x}, {&y, log_y}});
        const auto& value = theme_colour(colour);
        // Opacity as gnuplot writes it: two hexadecimal digits of transparency before the colour.
        items_.push_back(fmt::format("{} using 1:2 with lines lc rgb '#{:02x}{:02x}{:02x}{:02x}' lw {:.3g} {}", name,
                                     static_cast<int>(std::lround(255 * (1 - opacity(0.25)))), value.red, value.green,
                                     value.blue, std::min(series.width, 1.0), title));
        break;
      }
    }
  }

  void add_heat_map(const HeatMap& map) {
    const auto columns = map.x.size(), rows = map.y.size();
    if (columns < 2 || rows < 2 || map.value.size() != columns * rows) return;
    // Cells reach half-way to their neighbours.
    const auto edges = [](const std::vector<double>& at, bool logarithmic) {
      std::vector<double> edge(at.size() + 1);
      const auto middle = [&](double a, double b) { return logarithmic ? std::sqrt(a * b) : 0.5 * (a + b); };
      for (std::size_t i = 1; i < at.size(); ++i) edge[i] = middle(at[i - 1], at[i]);
      const auto mirror = [&](double centre, double inner) {
        return logarithmic ? centre * centre / inner : 2 * centre - inner;
      };
      edge.front() = mirror(at.front(), edge[1]);
      edge.back() = mirror(at.back(), edge[at.size() - 1]);
      return edge;
    };
    const auto x_edges = edges(map.x, plot_.log_x), y_edges = edges(map.y, plot_.log_y);
    any_data_ = true;
    const auto cells = begin_block();
    for (std::size_t j = 0; j < rows; ++j) {
      for (std::size_t i = 0; i < columns; ++i) {
        const double value = map.value[j * columns + i];
        if (!std::isfinite(value)) continue;
        blocks_ += fmt::format("{:.7g} {:.7g} {:.7g} {:.7g} {:.7g} {:.7g} {:.5g}\n", map.x[i], map.y[j], x_edges[i],
                               x_edges[i + 1], y_edges[j], y_edges[j + 1], value);
      }
    }
    blocks_ += "END\n";
    // Cividis: even steps of lightness, the same to colour-blind eyes, readable in grey.
    add("set palette defined (0 '#00204c', 0.25 '#414d6b', 0.5 '#7c7b78', 0.75 '#bcaf6f', 1 '#ffe945')");
    add(
        fmt::format("set cblabel {} tc {} offset 1,0; set cbtics scale 0 tc {}; set colorbox user origin graph 1.02, "
                    "graph 0 size graph 0.025, graph 1 noborder",
                    text(map.label), rgb(Colour::ink), rgb(Colour::ink)));
    if (map.range) add(fmt::format("set cbrange [{:.9g}:{:.9g}]", (*map.range)[0], (*map.range)[1]));
    if (!plot_.x_range) add(fmt::format("set xrange [{:.9g}:{:.9g}]", x_edges.front(), x_edges.back()));
    if (!plot_.y_range) add(fmt::format("set yrange [{:.9g}:{:.9g}]", y_edges.front(), y_edges.back()));
    items_.push_back(
        fmt::format("{} using 1:2:3:4:5:6:7 with boxxyerror fs solid 1 noborder fc palette notitle", cells));
    if (map.contours.empty()) return;
    const auto grid = begin_block();
    for (std::size_t j = 0; j < rows; ++j) {
      for (std::size_t i = 0; i < columns; ++i) {
        const double value = map.value[j * columns + i];
        blocks_ += fmt::format("{:.7g} {:.7g} {}\n", map.x[i], map.y[j],
                               std::isfinite(value) ? fmt::format("{:.7g}", value) : "NaN");
      }
      blocks_ += "\n";
    }
    blocks_ += "END\n";
    // Seen on the dark and on the bright end of the scale, and the same in both dresses of the page.
    constexpr const char* kContour[] = {"#d64a00", "#c2188b", "#1a9c4b", "#7d858f"};
    for (std::size_t i = 0; i < map.contours.size(); ++i) {
      const auto lines = fmt::format("$c{}", block_count_++);
      // Contours are computed on a linear frame of their own, then drawn like any line.
      add(fmt::format(
          "set contour base; unset surface; set cntrparam levels discrete {:.9g}; set table {}; splot {} using "
          "1:2:3 with lines notitle; unset table; unset contour; set surface",
          map.contours[i], lines, grid));
      items_.push_back(fmt::format("{} using 1:2 with lines lc {} lw 2.2 title {}", lines,
                                   fmt::format("rgb '{}'", kContour[i % 4]),
                                   text(fmt::format("{} = {:g}", map.label, map.contours[i]))));
    }
  }
};

}  // namespace

const ThemeColour& theme_colour(Colour colour) {
  return kColours[static_cast<std::size_t>(colour)];
}
std::span<const ThemeColour> theme_colours() {
  return std::span(kColours).subspan(1);
}

std::string gnuplot_script(const Plot& plot, const std::filesystem::path& output) {
  return Script(plot).build(output);
}

void thin(std::vector<double>& x, std::vector<double>& y, bool log_x, std::size_t columns) {
  const auto count = std::min(x.size(), y.size());
  if (count <= 4 * columns) return;
  std::vector<double> thin_x, thin_y;
  const auto keep = [&](std::size_t i) {
    thin_x.push_back(x[i]);
    thin_y.push_back(y[i]);
  };
  if (!std::is_sorted(x.begin(), x.end()) || (log_x && x.front() <= 0)) {
    const auto stride = (count + 4 * columns - 1) / (4 * columns);
    for (std::size_t i = 0; i < count; i += stride) keep(i);
  } else {
    const auto position = [&](double value) { return log_x ? std::log(value) : value; };
    const double first = position(x.front()), span = std::max(position(x[count - 1]) - first, 1e-300);
    for (std::size_t begin = 0; begin < count;) {
      const auto column = std::floor((position(x[begin]) - first) / span * static_cast<double>(columns));
      std::size_t end = begin, low = begin, high = begin;
      while (end < count && std::floor((position(x[end]) - first) / span * static_cast<double>(columns)) == column) {
        if (y[end] < y[low] || std::isnan(y[low])) low = end;
        if (y[end] > y[high] || std::isnan(y[high])) high = end;
        ++end;
      }
      std::array kept{begin, std::min(low, high), std::max(low, high), end - 1};
      for (std::size_t i = 0; i < kept.size(); ++i) {
        if (i == 0 || kept[i] != kept[i - 1]) keep(kept[i]);
      }
      begin = end;
    }
  }
  x = std::move(thin_x);
  y = std::move(thin_y);
}

}  // namespace handloop::io::detail
