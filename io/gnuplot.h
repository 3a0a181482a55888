#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "io/plot.h"

/// How plots become gnuplot commands, and gnuplot's SVG becomes one that fits a page. Used by plot.cpp only.
namespace handloop::io::detail {

/// The commands that draw one plot into a file.
std::string gnuplot_script(const Plot& plot, const std::filesystem::path& output);

/// gnuplot's SVG without its prologue, with colours that a page can change (CSS variables --hl-..., which fall back to
/// the colours of a light page) and identifiers that begin with `prefix`, so that many may stand in one page.
std::string adapt_svg(const std::string& svg, const std::string& prefix, const std::string& title);

/// Value of a colour on a light page, and name of its CSS variable.
struct ThemeColour {
  const char* variable;
  int red, green, blue;
  const char* dark;  ///< the same on a dark page
};
const ThemeColour& theme_colour(Colour colour);
std::span<const ThemeColour> theme_colours();

/// A line's points thinned to the extremes of about 700 columns, where x ascends; every n-th point otherwise.
void thin(std::vector<double>& x, std::vector<double>& y, bool log_x, std::size_t columns = 700);

}  // namespace handloop::io::detail
