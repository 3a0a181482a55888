#include "io/plot.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iterator>

#include "io/gnuplot.h"
#include "io/mapped_file.h"
#include "models/errors.h"

extern char** environ;

namespace handloop::io {
namespace fs = std::filesystem;
namespace {

/// A folder for the script and what it draws; gone with the object.
class WorkFolder {
 public:
  WorkFolder() {
    auto pattern = (fs::temp_directory_path() / "handloop_plots_XXXXXX").string();
    if (::mkdtemp(pattern.data()) == nullptr) throw RequirementError("no folder for plots can be made in " + pattern);
    path_ = pattern;
  }
  ~WorkFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  WorkFolder(const WorkFolder&) = delete;
  WorkFolder& operator=(const WorkFolder&) = delete;
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

/// Runs gnuplot on a script; what it says goes to a file beside it.
void run_gnuplot(const fs::path& script) {
  const auto messages = script.string() + ".messages";
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  ::posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, messages.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  ::posix_spawn_file_actions_adddup2(&actions, STDOUT_FILENO, STDERR_FILENO);
  std::string program = "gnuplot", no_settings = "-d", file = script.string();
  char* arguments[] = {program.data(), no_settings.data(), file.data(), nullptr};
  pid_t child = 0;
  const int error = ::posix_spawnp(&child, program.c_str(), &actions, nullptr, arguments, environ);
  ::posix_spawn_file_actions_destroy(&actions);
  if (error != 0)
    throw RequirementError("gnuplot, which draws the plots, is not installed; sudo apt install gnuplot-nox");
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return;
  std::ifstream said(messages);
  std::string line, last;
  while (std::getline(said, line)) {
    if (line.find_first_not_of(" \t^") != std::string::npos) last = line;
  }
  throw RequirementError("gnuplot failed: " + last);
}

}  // namespace

Series histogram(std::span<const double> values, std::size_t bins, std::string label, bool density) {
  Series series{.label = std::move(label), .style = Series::Style::bars};
  std::vector<double> finite;
  std::copy_if(values.begin(), values.end(), std::back_inserter(finite),
               [](double value) { return std::isfinite(value); });
  if (finite.empty() || bins == 0) return series;
  const auto [low, high] = std::minmax_element(finite.begin(), finite.end());
  const double start = *low, width = (*high > *low ? *high - *low : 1.0) / static_cast<double>(bins);
  series.y.assign(bins, 0.0);
  for (const double value : finite) {
    const auto bin = static_cast<std::size_t>(std::max(0.0, (value - start) / width));
    series.y[std::min(bin, bins - 1)] += density ? 1.0 / (static_cast<double>(finite.size()) * width) : 1.0;
  }
  for (std::size_t i = 0; i < bins; ++i) {
    series.lower.push_back(start + width * static_cast<double>(i));
    series.upper.push_back(start + width * static_cast<double>(i + 1));
    series.x.push_back(0.5 * (series.lower.back() + series.upper.back()));
  }
  return series;
}

std::vector<std::string> draw_svg(std::span<const Plot> plots) {
  std::vector<std::string> drawn;
  if (plots.empty()) return drawn;
  const WorkFolder folder;
  const auto output = [&](std::size_t i) { return folder.path() / fmt::format("{}.svg", i); };
  {
    std::ofstream script(folder.path() / "plots.gp");
    for (std::size_t i = 0; i < plots.size(); ++i) script << detail::gnuplot_script(plots[i], output(i));
  }
  run_gnuplot(folder.path() / "plots.gp");
  for (std::size_t i = 0; i < plots.size(); ++i) {
    drawn.push_back(detail::adapt_svg(read_file(output(i)), fmt::format("p{}", i), plots[i].title));
  }
  return drawn;
}

std::string draw_svg(const Plot& plot) {
  return draw_svg(std::span(&plot, 1)).front();
}

}  // namespace handloop::io
