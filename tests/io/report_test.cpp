#include "io/report.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <numeric>
#include <set>
#include <string>

#include "io/gnuplot.h"
#include "io/html_text.h"
#include "io/mapped_file.h"

namespace handloop::io {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

Plot every_style() {
  Plot plot{.title = "all <styles>", .x_label = "frequency, Hz", .y_label = "it's 100 % 'quoted'"};
  const std::vector<double> x{1, 2, 3, 4}, y{2, kNaN, 3, 1}, low{1, 1, 2, 0.5}, high{3, 3, 4, 2};
  for (const auto style : {Series::Style::line, Series::Style::points, Series::Style::line_points, Series::Style::steps,
                           Series::Style::band, Series::Style::intervals, Series::Style::bars,
                           Series::Style::horizontal_bars, Series::Style::fan}) {
    plot.series.push_back({.label = "series $1 \\n", .x = x, .y = y, .style = style, .lower = low, .upper = high});
  }
  plot.vertical = {{2.5, "here"}, {kNaN, "nowhere"}};
  plot.horizontal = {{1.5, "there"}};
  plot.annotations = {{1, 2, "a word"}};
  return plot;
}

std::size_t count(const std::string& text, const std::string& word) {
  std::size_t found = 0;
  for (auto at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++found;
  return found;
}

TEST(Plot, OfEveryStyleIsDrawn) {
  const auto svg = draw_svg(every_style());
  EXPECT_TRUE(svg.starts_with("<svg"));
  EXPECT_NE(svg.find("</svg>"), std::string::npos);
  EXPECT_NE(svg.find("it's 100 % 'quoted'"), std::string::npos) << "labels are text, not commands";
  EXPECT_NE(svg.find("series $1 \\n"), std::string::npos);
  EXPECT_NE(svg.find("here"), std::string::npos);
  EXPECT_EQ(svg.find("nowhere"), std::string::npos);
  EXPECT_NE(svg.find("var(--hl-blue,#0072b2)"), std::string::npos) << "colours follow the page";
}

TEST(Plot, OfNothingIsAnEmptyFrame) {
  EXPECT_NE(draw_svg(Plot{.title = "empty"}).find("</svg>"), std::string::npos);
  Plot plot{.log_x = true, .log_y = true};
  plot.series = {{.label = "nothing positive", .x = {-1, 0}, .y = {0, -1}}};
  EXPECT_NE(draw_svg(plot).find("</svg>"), std::string::npos);
}

TEST(Plot, HeatMapHasItsContours) {
  Plot plot;
  HeatMap map{.label = "P(stable)", .contours = {0.5}};
  for (int i = 0; i < 12; ++i) map.x.push_back(std::pow(10, 0.2 * i));
  for (int j = 0; j < 9; ++j) map.y.push_back(j);
  for (const double y : map.y) {
    for (const double x : map.x) map.value.push_back(x < 10 * y ? 1 : 0.1);
  }
  plot.heat_map = map;
  plot.log_x = true;
  const auto svg = draw_svg(plot);
  EXPECT_NE(svg.find("P(stable) = 0.5"), std::string::npos);
  EXPECT_NE(svg.find("#d64a00"), std::string::npos);
}

TEST(Plot, ManyPlotsInOnePageDoNotShareNames) {
  const std::vector<Plot> plots(3, every_style());
  const auto drawn = draw_svg(plots);
  std::set<std::string> names;
  std::size_t total = 0;
  for (const auto& svg : drawn) {
    for (auto at = svg.find("id='"); at != std::string::npos; at = svg.find("id='", at + 1)) {
      names.insert(svg.substr(at + 4, svg.find('\'', at + 4) - at - 4));
      ++total;
    }
  }
  EXPECT_GT(total, 0U);
  EXPECT_EQ(names.size(), total);
}

TEST(Plot, ThinningKeepsEveryPeak) {
  std::vector<double> x(100000), y(100000, 0.0);
  std::iota(x.begin(), x.end(), 0.0);
  y[31415] = 7;
  y[92653] = -9;
  detail::thin(x, y, false);
  EXPECT_LT(x.size(), 4000U);
  EXPECT_EQ(*std::max_element(y.begin(), y.end()), 7);
  EXPECT_EQ(*std::min_element(y.begin(), y.end()), -9);
  EXPECT_EQ(x.front(), 0);
  EXPECT_EQ(x.back(), 99999);
  EXPECT_TRUE(std::is_sorted(x.begin(), x.end()));
}

TEST(Plot, HistogramCountsEveryFiniteValueOnce) {
  const std::vector<double> values{0, 0.1, 0.9, 1.0, kNaN, 0.5};
  const auto bars = histogram(values, 2, "values");
  EXPECT_EQ(bars.y, (std::vector<double>{2, 3}));
  const auto density = histogram(values, 4, "values", true);
  double area = 0;
  for (std::size_t i = 0; i < 4; ++i) area += density.y[i] * (density.upper[i] - density.lower[i]);
  EXPECT_NEAR(area, 1, 1e-12);
  EXPECT_TRUE(histogram({}, 4, "none").y.empty());
  EXPECT_EQ(histogram(std::vector<double>{3, 3}, 4, "one value").y.front(), 2);
}

Report sample() {
  Report report("Margins <of> a wall", "at 400 N/m");
  report.figures({{"phase margin", "41 deg", "at 8 Hz", Figure::Mood::good}})
      .section("First & last")
      .paragraph("Plain, `code <x>`, **strong** and [a link](#margins), no <script>alert(1)</script>.")
      .callout(Report::Tone::assumption, "Parameters are drawn independently.")
      .section("First & last")
      .table({{"name", "value"}, {{"gain", "2.5"}, {"delay", "∞"}}, "caption"})
      .plots({every_style(), every_style()}, "two")
      .plot(every_style())
      .section("Code")
      .code("a < b\n\"c\"");
  return report;
}

TEST(Report, StandsAlone) {
  const auto page = sample().to_html();
  // The only addresses are the names of the SVG vocabulary.
  EXPECT_EQ(count(page, "http"), count(page, "http://www.w3.org/"));
  for (const auto* word : {"<link", "<script", "@import", "url(", "src="}) EXPECT_EQ(count(page, word), 0U) << word;
  EXPECT_EQ(count(page, "<svg"), 3U);
  EXPECT_NE(page.find("prefers-color-scheme:dark"), std::string::npos);
}

TEST(Report, ShowsTextAsItIs) {
  const auto page = sample().to_html();
  EXPECT_NE(page.find("Margins &lt;of&gt; a wall"), std::string::npos);
  EXPECT_NE(page.find("<code>code &lt;x&gt;</code>"), std::string::npos);
  EXPECT_NE(page.find("<strong>strong</strong>"), std::string::npos);
  EXPECT_NE(page.find("<a href=\"#margins\">a link</a>"), std::string::npos);
  EXPECT_NE(page.find("&lt;script&gt;"), std::string::npos);
  EXPECT_NE(page.find("<td class=\"n\">2.5</td>"), std::string::npos) << "numbers stand to the right";
  EXPECT_NE(page.find("<td>gain</td>"), std::string::npos);
  EXPECT_EQ(count(page, "id=\"first-last\""), 1U);
  EXPECT_EQ(count(page, "id=\"first-last-2\""), 1U);
}

TEST(Report, OfTheSamePiecesIsTheSameBytes) {
  EXPECT_EQ(sample().to_html(), sample().to_html());
}

TEST(Html, UnfinishedMarkupIsPlainText) {
  EXPECT_EQ(markup_to_html("a ` b ** c [d](javascript:x) e"), "a ` b ** c [d](javascript:x) e");
  EXPECT_EQ(markup_to_html("2 * 3 ** 4"), "2 * 3 ** 4");
}

TEST(Html, NumbersReadWell) {
  EXPECT_EQ(pretty(0.123456), "0.1235");
  EXPECT_EQ(pretty(std::numeric_limits<double>::infinity()), "∞");
  EXPECT_EQ(pretty(kNaN), "–");
}

}  // namespace
}  // namespace handloop::io
