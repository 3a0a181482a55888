#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

/// Plots as plain data, drawn by gnuplot into SVG. What is not finite (and what is not positive on a logarithmic axis)
/// leaves a gap. Long lines are thinned to what the eye can see: extremes of every pixel column stay.
namespace handloop::io {

/// Colours that stay apart for colour-blind eyes (Okabe and Ito) and change with the page's light or dark dress.
enum class Colour { automatic, blue, orange, green, purple, amber, sky, grey, ink };

struct Series {
  enum class Style {
    line,             ///< y over x
    points,           ///< y over x
    line_points,      ///< y over x
    steps,            ///< y held from each x to the next
    band,             ///< between lower and upper, over x
    intervals,        ///< y over x with whiskers from lower to upper
    bars,             ///< height y between x = lower and x = upper
    horizontal_bars,  ///< length x at y, half a unit thick
    fan               ///< many lines, all of one colour and faint: NaN in y separates them
  };
  std::string label{};  ///< for the legend; empty: not listed
  std::vector<double> x{}, y{};
  Style style = Style::line;
  Colour colour = Colour::automatic;
  std::vector<double> lower{}, upper{};
  double width = 1.8;  ///< of lines, px
  bool dashed = false;
  double opacity = 0.0;  ///< 0: usual for the style
};

/// A line across the whole plot, with a word beside it.
struct Mark {
  double at = 0.0;
  std::string label{};
  Colour colour = Colour::grey;
  bool dashed = true;
};

/// A word at a point, in the units of the axes.
struct Annotation {
  double x = 0.0;
  double y = 0.0;
  std::string text{};
};

/// A field over a grid: colours, and contours at chosen levels.
struct HeatMap {
  std::vector<double> x{}, y{};  ///< where the values are, ascending
  std::vector<double> value{};   ///< y.size() rows of x.size()
  std::string label{};           ///< of the colour scale
  std::optional<std::array<double, 2>> range{};
  std::vector<double> contours{};
};

struct Plot {
  std::string title{};
  std::string x_label{}, y_label{};
  bool log_x = false;
  bool log_y = false;
  std::optional<std::array<double, 2>> x_range{}, y_range{};
  std::vector<Series> series{};
  std::vector<Mark> vertical{}, horizontal{};
  std::vector<Annotation> annotations{};
  std::optional<HeatMap> heat_map{};
  std::vector<std::string> x_categories{}, y_categories{};  ///< names at 1, 2, 3, ... in the place of numbers
  bool equal_axes = false;                                  ///< one unit is as long on both axes
  bool reverse_y = false;
  double width_px = 900;
  double height_px = 400;
};

/// Bars that count values in equal bins between the extremes; as densities of area 1 where asked.
Series histogram(std::span<const double> values, std::size_t bins, std::string label, bool density = false);

/// One SVG document for each plot, drawn by one gnuplot process. Throws RequirementError where gnuplot is missing or
/// fails.
std::vector<std::string> draw_svg(std::span<const Plot> plots);
std::string draw_svg(const Plot& plot);

}  // namespace handloop::io
