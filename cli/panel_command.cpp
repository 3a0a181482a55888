#include <charconv>
#include <memory>

#include "cli/commands.h"
#include "cli/scenario_argument.h"
#include "models/errors.h"
#include "ui/app/panel.h"

namespace handloop::cli {
namespace {

struct Options {
  std::string scenario, screenshot, size = "1280x800", describe;
  ui::PanelOptions panel;
};

/// "1280x800" to width and height. Throws InputError.
void parse_size(const std::string& text, int& width, int& height) {
  const char *end = text.data() + text.size(), *from = text.data();
  const auto first = std::from_chars(from, end, width);
  const bool crossed = first.ec == std::errc() && first.ptr != end && *first.ptr == 'x';
  const auto second = crossed ? std::from_chars(first.ptr + 1, end, height) : first;
  if (!crossed || second.ec != std::errc() || second.ptr != end)
    throw InputError("panel: --size " + text + ": give width and height as in 1280x800");
}

void run(const Options& given) {
  auto panel = given.panel;
  panel.scenario = read_scenario_argument(given.scenario);
  panel.scenario_path = given.scenario;
  parse_size(given.size, panel.width, panel.height);
  if (!given.screenshot.empty()) panel.screenshot = given.screenshot;
  if (!given.describe.empty()) panel.describe = given.describe;
  ui::run_panel(panel);
}

}  // namespace

void add_panel_command(CLI::App& program) {
  auto options = std::make_shared<Options>();
  auto* command =
      program.add_subcommand("panel", "The window: tune gains with the margins alive, explore arms, explain data");
  command->add_option("scenario", options->scenario, "Scenario file (default: the Phantom at a virtual wall)");
  command->add_option("--screenshot", options->screenshot, "Draw --frames frames, save what is shown as PNG, and end");
  command->add_option("--frames", options->panel.frames, "Frames before the screenshot")->capture_default_str();
  command->add_option("--size", options->size, "Of the window, in pixels")->capture_default_str();
  command->add_option("--scale", options->panel.scale, "Of text and everything, 1 to 2 (default: the monitor's)");
  command->add_option("--theme", options->panel.theme, "dark or light")->capture_default_str();
  command->add_option("--view", options->panel.view, "First view: tune, arms, subject, data, traces or device")
      ->capture_default_str();
  command->add_option("--recording", options->panel.recording, "Recording to open in the data view");
  command->add_option("--describe", options->describe,
                      "Keep this JSON file up to date with what is on the screen, for scripts");
  command->footer("Example: handloop panel scenes/phantom_wall.toml");
  command->callback([options] { run(*options); });
}

}  // namespace handloop::cli
