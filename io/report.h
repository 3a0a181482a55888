#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "io/plot.h"

namespace handloop::io {

/// Rows of text. Columns whose cells are numbers are aligned to the right.
struct Table {
  std::vector<std::string> columns{};
  std::vector<std::vector<std::string>> rows{};
  std::string caption{};
};

/// A key figure: what stands in a card at the top of a section.
struct Figure {
  enum class Mood { neutral, good, bad };
  std::string label{};  ///< "phase margin"
  std::string value{};  ///< "41.2 deg"
  std::string note{};   ///< "at 8.3 Hz"
  Mood mood = Mood::neutral;
};

/// A self-contained HTML page: inline SVG, no network, light or dark as the reader's system is, fit to print.
/// Pieces appear in the order in which they are added. Text may hold `code`, **strong** and [links](#section); all else
/// is shown as it is. The same pieces give the same bytes.
class Report {
 public:
  enum class Tone { note, good, warning, assumption };

  explicit Report(std::string title, std::string subtitle = "");

  Report& section(std::string_view heading);
  Report& subsection(std::string_view heading);
  Report& paragraph(std::string_view text);
  Report& list(const std::vector<std::string>& items);
  /// A paragraph that stands out, its tone in words as well as in colour.
  Report& callout(Tone tone, std::string_view text);
  Report& figures(const std::vector<Figure>& figures);
  Report& table(const Table& table);
  Report& plot(Plot plot, std::string_view caption = "");
  /// Plots side by side where the page is wide enough.
  Report& plots(std::vector<Plot> plots, std::string_view caption = "");
  /// Text as it is, in a fixed pitch: commands, files.
  Report& code(std::string_view text);
  /// Ready-made HTML, not escaped.
  Report& html(std::string_view html);

  /// The whole page; draws every plot in one go. Throws RequirementError where gnuplot is missing.
  std::string to_html() const;
  /// Writes the page whole or not at all.
  void write(const std::filesystem::path& path) const;

 private:
  struct Section {
    std::string heading, id;
  };
  /// HTML, followed by the plot of that number where there is one.
  struct Piece {
    std::string html;
    int plot = -1;
  };
  std::string title_, subtitle_;
  std::vector<Section> sections_;
  std::vector<Piece> pieces_;
  std::vector<Plot> plots_;

  Report& add(std::string html);
};

/// A number as people read it: so many significant digits, "inf" as the sign for infinity, an en dash where there is
/// none.
std::string pretty(double value, int digits = 4);

}  // namespace handloop::io
