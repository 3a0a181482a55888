#include "tests/ui/desktop.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <thread>

#include "tests/support/sanitized.h"

namespace handloop::ui {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

/// Starts a program with its words, on a display; output to a file.
pid_t start(std::vector<std::string> words, const std::string& display, const std::string& folder, int kept = -1) {
  const pid_t child = fork();
  if (child != 0) return child;
  std::vector<char*> argv;
  for (auto& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  if (!display.empty()) setenv("DISPLAY", display.c_str(), 1);
  const int log = open((folder + "/" + fs::path(words[0]).filename().string() + ".txt").c_str(),
                       O_CREAT | O_WRONLY | O_APPEND, 0644);
  dup2(log, STDOUT_FILENO);
  dup2(log, STDERR_FILENO);
  if (kept >= 0) fcntl(kept, F_SETFD, 0);
  if (chdir(folder.c_str()) != 0) _exit(126);
  execvp(argv[0], argv.data());
  _exit(127);
}

void end(int& process, int signal) {
  if (process <= 0) return;
  kill(process, signal);
  int status = 0;
  waitpid(process, &status, 0);
  process = -1;
}

}  // namespace

bool Desktop::possible() {
  const auto there = [](const char* name) { return fs::exists(fs::path("/usr/bin") / name); };
  return there("Xvfb") && there("xdotool");
}

std::string Desktop::pictures() {
  const auto folder = fs::path(HANDLOOP_PROGRAM).parent_path() / "panel_pictures";
  fs::create_directories(folder);
  return folder.string();
}

Desktop::Desktop(const std::vector<std::string>& arguments, int width, int height) {
  std::string name = (fs::temp_directory_path() / "handloop_panel_XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
  folder_ = name;
  int pipe_ends[2];
  if (pipe(pipe_ends) != 0) throw std::runtime_error("no pipe");
  screen_ = start({"Xvfb", "-displayfd", std::to_string(pipe_ends[1]), "-screen", "0",
                   std::to_string(width) + "x" + std::to_string(height) + "x24", "-nolisten", "tcp"},
                  "", folder_, pipe_ends[1]);
  close(pipe_ends[1]);
  char number[16] = {};
  if (read(pipe_ends[0], number, sizeof number - 1) <= 0) throw std::runtime_error("Xvfb does not start");
  close(pipe_ends[0]);
  display_ = ":" + std::to_string(std::atoi(number));
  std::vector<std::string> words{HANDLOOP_PROGRAM, "panel",
                                 "--describe",     folder_ + "/shown.json",
                                 "--size",         std::to_string(width) + "x" + std::to_string(height)};
  words.insert(words.end(), arguments.begin(), arguments.end());
  panel_ = start(words, display_, folder_);
  if (!until([](const auto& shown) { return shown.contains("verdict"); }))
    throw std::runtime_error("the panel does not come up");
  // no window manager here gives the keyboard to anybody
  xdotool({"search", "--sync", "--name", "handloop", "windowfocus", "--sync"});
}

Desktop::~Desktop() {
  end(panel_, SIGTERM);
  end(screen_, SIGTERM);
  std::error_code ignored;
  fs::remove_all(folder_, ignored);
}

nlohmann::json Desktop::shown() const {
  std::ifstream file(folder_ + "/shown.json");
  return nlohmann::json::parse(file, nullptr, false);
}

bool Desktop::until(const std::function<bool(const nlohmann::json&)>& come, int seconds) const {
  for (int i = 0; i < 20 * seconds * tests::kSlower; ++i) {
    const auto now = shown();
    if (!now.is_discarded() && come(now)) return true;
    std::this_thread::sleep_for(50ms);
  }
  return false;
}

bool Desktop::until_named(const std::string& landmark) const {
  return until([&](const auto& shown) { return shown["landmarks"].contains(landmark); });
}

void Desktop::xdotool(const std::vector<std::string>& arguments) const {
  std::vector<std::string> words{"xdotool"};
  words.insert(words.end(), arguments.begin(), arguments.end());
  int process = start(words, display_, folder_);
  int status = 0;
  waitpid(process, &status, 0);
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) throw std::runtime_error("xdotool " + arguments[0] + " failed");
}

void Desktop::move_to(const std::string& landmark, double right, double down) {
  if (!until_named(landmark)) throw std::runtime_error("nothing is named " + landmark);
  const auto place = shown()["landmarks"][landmark];
  const double x = place["x"].get<double>() + (right - 0.5) * place["width"].get<double>();
  const double y = place["y"].get<double>() + (down - 0.5) * place["height"].get<double>();
  xdotool({"mousemove", std::to_string(static_cast<int>(x)), std::to_string(static_cast<int>(y))});
  rest();
}

void Desktop::press(bool down) {
  xdotool({down ? "mousedown" : "mouseup", "1"});
  rest();
}

void Desktop::click(const std::string& landmark, double right, double down) {
  move_to(landmark, right, down);
  press(true);
  press(false);
}

bool Desktop::type_value(const std::string& slider, const std::string& value, const std::string& key) {
  const double wanted = std::stod(value);
  for (const int hold_ms : {150, 500, 1500}) {
    hold_ms_ = hold_ms;
    move_to(slider);
    xdotool({"keydown", "ctrl"});
    rest();
    press(true);
    press(false);
    xdotool({"keyup", "ctrl"});
    rest();
    keys("ctrl+a");
    type(value);
    keys("Return");
    if (until([&](const auto& shown) { return shown[key] == wanted; }, 5)) return true;
  }
  return false;
}

void Desktop::keys(const std::string& combination) {
  std::vector<std::string> down{"keydown"}, up{"keyup"};
  std::istringstream parts(combination);
  for (std::string part; std::getline(parts, part, '+');) down.push_back(part), up.insert(up.begin() + 1, part);
  xdotool(down);
  rest();
  xdotool(up);
  rest();
}

void Desktop::rest() const {
  std::this_thread::sleep_for(std::chrono::milliseconds(hold_ms_));
}

void Desktop::type(const std::string& text) {
  xdotool({"type", "--delay", "150", text});
  std::this_thread::sleep_for(200ms);
}

void Desktop::picture(const std::string& name) {
  const auto made = fs::path(folder_) / "handloop_panel.png";
  keys("F12");
  for (int i = 0; i < 200 && !fs::exists(made); ++i) std::this_thread::sleep_for(50ms);
  fs::copy_file(made, fs::path(pictures()) / (name + ".png"), fs::copy_options::overwrite_existing);
  fs::remove(made);
}

int Desktop::quit() {
  keys("ctrl+q");
  int status = 0;
  waitpid(panel_, &status, 0);
  panel_ = -1;
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

bool Desktop::alive() const {
  return panel_ > 0 && kill(panel_, 0) == 0;
}

}  // namespace handloop::ui
