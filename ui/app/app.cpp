#include "ui/app/app.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>

#include "io/output.h"
#include "models/errors.h"
#include "ui/app/description.h"
#include "ui/views/controls_view.h"
#include "ui/views/subject_view.h"
#include "ui/views/tune_view.h"
#include "ui/widgets/fields.h"
#include "ui/widgets/landmarks.h"
#include "ui/widgets/look.h"

namespace handloop::ui {
namespace {

double seconds_now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

constexpr std::array<std::pair<View, const char*>, 6> kViews{{{View::tune, "Tune"},
                                                              {View::arms, "Arms"},
                                                              {View::subject, "Subject"},
                                                              {View::data, "Data"},
                                                              {View::traces, "Traces"},
                                                              {View::device, "Device"}}};
constexpr std::array<const char*, 6> kViewNames{"tune", "arms", "subject", "data", "traces", "device"};

View view_of(const std::string& name) {
  const auto found = std::ranges::find(kViewNames, name);
  if (found == kViewNames.end())
    throw InputError("panel: --view " + name + ": give one of tune, arms, subject, data, traces, device");
  return static_cast<View>(found - kViewNames.begin());
}

Brightness brightness_of(const std::string& theme) {
  if (theme != "dark" && theme != "light") throw InputError("panel: --theme " + theme + ": give dark or light");
  return theme == "dark" ? Brightness::dark : Brightness::light;
}

}  // namespace

App::App(const PanelOptions& options)
    : options_(options),
      brightness_(brightness_of(options.theme)),
      first_view_(view_of(options.view)),
      window_(options.width, options.height, "handloop"),
      bench_(options.scenario, options.scenario_path),
      scene_(options.scenario),
      scale_(options.scale > 0 ? static_cast<float>(options.scale) : std::clamp(window_.content_scale(), 1.0f, 2.0f)) {
  bench_.view = first_view_;
  Landmarks::all().listening = options.describe.has_value();
  if (!options.recording.empty()) data_.open(bench_, options.recording);
}

template <typename Work>
void App::attempt(Work&& work) {
  try {
    work();
  } catch (const std::exception& error) {
    bench_.say(error.what(), true);
  }
}

void App::run() {
  int drawn = 0;
  const double begin = seconds_now();
  while (!window_.closing()) {
    frame();
    if (options_.screenshot && ++drawn >= options_.frames) {
      io::write_file_atomically(*options_.screenshot, png(window_.pixels()));
      fmt::print("{} frames, {:.1f} a second; at most {:.1f} ms before a frame is drawn\n", drawn,
                 drawn / (seconds_now() - begin), 1e3 * longest_layout_s_);
      return;
    }
    window_.show_frame();
  }
}

void App::frame() {
  const double now = seconds_now();
  if (bench_.now_s > 0) bench_.frames_per_s += 0.1 * (1 / std::max(now - bench_.now_s, 1e-4) - bench_.frames_per_s);
  bench_.now_s = now;
  if (std::exchange(look_changed_, false)) {
    apply_look(brightness_, scale_);
    window_.fonts_changed();
  }
  window_.begin_frame();
  Landmarks::all().begin_frame();
  for (const auto command : commands_of(window_.take_keys(), ImGui::GetIO().WantTextInput)) obey(command);
  const auto& editor = bench_.editor;
  bench_.tuning.follow(editor.scenario(), editor.revision());
  bench_.session.follow(editor.scenario(), editor.revision());
  layout();
  longest_layout_s_ = ++frames_ > 5 ? std::max(longest_layout_s_, seconds_now() - now) : 0.0;
  const auto& background = palette().window;
  window_.end_frame([this](int height, float ratio) { scene_.render(bench_, height, ratio); }, background.r,
                    background.g, background.b);
  after_drawing();
}

void App::obey(Command command) {
  auto& session = bench_.session;
  const auto look = [this](float scale) {
    scale_ = std::clamp(scale, 1.0f, 2.0f);
    look_changed_ = true;
  };
  switch (command) {
    case Command::stop:
      session.stop();
      break;
    case Command::undo:
      if (bench_.editor.undo()) bench_.say("undone");
      break;
    case Command::redo:
      if (bench_.editor.redo()) bench_.say("done again");
      break;
    case Command::open:
      ask_open();
      break;
    case Command::save:
      if (bench_.editor.path().empty()) {
        ask_save();
      } else {
        save(bench_.editor.path());
      }
      break;
    case Command::save_as:
      ask_save();
      break;
    case Command::pause:
      session.set_paused(!session.paused());
      break;
    case Command::single_step:
      session.single_step();
      break;
    case Command::reset:
      session.reset();
      break;
    case Command::larger:
      look(scale_ + 0.25f);
      break;
    case Command::smaller:
      look(scale_ - 0.25f);
      break;
    case Command::theme:
      brightness_ = brightness_ == Brightness::dark ? Brightness::light : Brightness::dark;
      look_changed_ = true;
      break;
    case Command::picture:
      picture_wanted_ = true;
      break;
    case Command::quit:
      window_.close();
      break;
    default:
      bench_.view = static_cast<View>(static_cast<int>(command) - static_cast<int>(Command::view_tune));
  }
}

void App::ask_open() {
  when_chosen_ = [this](const std::filesystem::path& path) {
    bench_.editor.load(path);
    bench_.say("opened " + path.string());
  };
  dialog_.ask("Open a scenario", FileDialog::Purpose::open, {".toml"},
              bench_.editor.path().empty() ? "scenes" : bench_.editor.path().parent_path());
}

void App::ask_save() {
  when_chosen_ = [this](const std::filesystem::path& path) { save(path); };
  dialog_.ask("Save the scenario", FileDialog::Purpose::save, {".toml"},
              bench_.editor.path().empty() ? "my_scenario.toml" : bench_.editor.path());
}

void App::save(const std::filesystem::path& path) {
  attempt([&] {
    bench_.editor.save(path);
    bench_.say("saved " + path.string() + "; handloop margins --scenario reads it");
  });
}

void App::layout() {
  const auto& io = ImGui::GetIO();
  ImGui::SetNextWindowPos({0, 0});
  ImGui::SetNextWindowSize(io.DisplaySize);
  ImGui::Begin("panel", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoBackground |
                   ImGuiWindowFlags_NoBringToFrontOnFocus | ImGuiWindowFlags_NoSavedSettings);
  top_bar();
  fault_banner();
  const float status = ImGui::GetFrameHeight();
  const ImVec2 room{ImGui::GetContentRegionAvail().x, ImGui::GetContentRegionAvail().y - status - px(2)};
  const float left = std::min(px(382), 0.46f * room.x);
  ImGui::BeginChild("left", {left, room.y}, false, ImGuiWindowFlags_NoBackground | ImGuiWindowFlags_NoScrollbar);
  scene_.layout(bench_, {0, std::clamp(0.46f * room.y, px(180), 0.9f * left)});
  ImGui::BeginChild("controls", {0, 0}, true);
  controls_view(bench_);
  ImGui::EndChild();
  ImGui::EndChild();
  ImGui::SameLine();
  ImGui::BeginChild("right", {0, room.y}, false, ImGuiWindowFlags_NoBackground);
  attempt([this] { current_view(); });
  ImGui::EndChild();
  status_line();
  if (const auto chosen = dialog_.show()) attempt([&] { when_chosen_(*chosen); });
  ImGui::End();
}

void App::bar_commands(bool beside) {
  const auto& history = bench_.editor.history();
  const auto button = [&](const char* name, const char* label, Command command, bool enabled, const std::string& tip) {
    ImGui::BeginDisabled(!enabled);
    if (push_button(name, label, false, beside ? 0.0f : px(110))) obey(command);
    ImGui::EndDisabled();
    hint(tip.c_str());
    if (beside) ImGui::SameLine(0, px(3));
  };
  button("open", "Open", Command::open, true, "A scenario (Ctrl+O)");
  button("save", "Save", Command::save, true, "As a scenario that the command line reads (Ctrl+S)");
  button("save_as", "Save as", Command::save_as, true, "Under another name (Ctrl+Shift+S)");
  button("undo", "Undo", Command::undo, history.can_undo(), "Ctrl+Z: " + history.undo_name());
  button("redo", "Redo", Command::redo, history.can_redo(), "Ctrl+Y");
  button("theme", brightness_ == Brightness::dark ? "Light" : "Dark", Command::theme, true, "Ctrl+T");
  button("smaller", "A-", Command::smaller, scale_ > 1.0f, "Smaller (Ctrl+-)");
  button("larger", "A+", Command::larger, scale_ < 2.0f, "Larger, to 200 % (Ctrl+=)");
}

void App::top_bar() {
  const auto& display = ImGui::GetIO().DisplaySize;
  const bool narrow = display.x < px(1100);
  for (const auto& [view, name] : kViews) {
    const auto index = static_cast<std::size_t>(view);
    if (push_button(std::string("view_") + kViewNames[index], name, bench_.view == view, narrow ? 0.0f : px(72)))
      bench_.view = view;
    ImGui::SameLine(0, px(3));
  }
  if (narrow) {
    if (push_button("menu", "Menu")) ImGui::OpenPopup("menu");
    if (ImGui::BeginPopup("menu")) {
      bar_commands(false);
      ImGui::EndPopup();
    }
    ImGui::SameLine(0, px(3));
  } else {
    ImGui::SameLine(0, px(18));
    bar_commands(true);
  }
  // what must be reachable always sits at the edge, in a colour that nothing else has
  ImGui::SameLine(ImGui::GetWindowWidth() - px(138) - ImGui::GetStyle().WindowPadding.x);
  ImGui::PushStyleColor(ImGuiCol_Button, vec(palette().stop));
  ImGui::PushStyleColor(ImGuiCol_ButtonHovered, vec(palette().stop.faded(0.85f)));
  ImGui::PushStyleColor(ImGuiCol_ButtonActive, vec(palette().stop.faded(0.7f)));
  {
    const TextStyle style(look().bold, Colour{1, 1, 1, 1});
    if (push_button("stop", "STOP  (Esc)", false, px(138))) obey(Command::stop);
  }
  ImGui::PopStyleColor(3);
  hint("The force goes to zero and stays there until Reset. Works by the Escape key wherever you are");
}

void App::fault_banner() {
  auto& session = bench_.session;
  if (!session.faulted()) return;
  const auto& event = session.status().fault;
  const auto& info = device::fault_info(event.fault);
  std::string text = fmt::format("{}", info.meaning);
  if (!info.unit.empty())
    text += fmt::format(": {:.4g} {} where {:.4g} is allowed", event.value, info.unit, event.limit);
  text += fmt::format(", at {:.3f} s", static_cast<double>(event.time_ns) * 1e-9);
  ImGui::PushStyleColor(ImGuiCol_ChildBg, vec(palette().unstable.faded(0.25f)));
  ImGui::BeginChild("fault", {0, ImGui::GetFrameHeight() + px(14)}, true, ImGuiWindowFlags_NoScrollbar);
  ImGui::PopStyleColor();
  {
    const TextStyle style(look().bold, palette().unstable);
    ImGui::AlignTextToFramePadding();
    ImGui::TextUnformatted("Stopped, force at zero:");
    mark("fault", text);
  }
  ImGui::SameLine();
  ImGui::TextUnformatted(text.c_str());
  ImGui::SameLine(ImGui::GetWindowWidth() - px(262));
  if (push_button("evidence", "See the evidence", false, px(140))) bench_.view = View::device;
  ImGui::SameLine(0, px(4));
  if (push_button("clear_fault", session.simulated() ? "Reset" : "Disarm", true, px(100))) session.reset();
  ImGui::EndChild();
}

void App::current_view() {
  switch (bench_.view) {
    case View::tune:
      return tune_view(bench_);
    case View::arms:
      return arms_.show(bench_);
    case View::subject:
      return subject_view(bench_);
    case View::data:
      return data_.show(bench_);
    case View::traces:
      return traces_.show(bench_);
    case View::device:
      return device_.show(bench_);
  }
}

void App::status_line() {
  const auto& session = bench_.session;
  const auto& p = palette();
  const bool bad = bench_.message_is_bad || !session.problem().empty() || !bench_.tuning.problem().empty();
  const std::string text = !session.problem().empty()         ? session.problem()
                           : !bench_.tuning.problem().empty() ? bench_.tuning.problem()
                                                              : bench_.message;
  const TextStyle style(look().small, bad ? p.unstable : p.muted);
  ImGui::AlignTextToFramePadding();
  ImGui::TextUnformatted(text.empty()
                             ? (bench_.editor.path().empty() ? "not saved yet" : bench_.editor.path().string().c_str())
                             : text.c_str());
  mark("status", text);
  const std::string right =
      fmt::format("{}   margins {:.2f} ms, {} arms {:.0f} ms   {:.0f} frames/s",
                  bench_.editor.changed() ? "changed" : "", 1e3 * bench_.tuning.nominal_seconds(), TuningJobs::kArms,
                  1e3 * bench_.tuning.population_seconds(), bench_.frames_per_s);
  ImGui::SameLine(ImGui::GetWindowWidth() - ImGui::CalcTextSize(right.c_str()).x - px(10));
  ImGui::PushStyleColor(ImGuiCol_Text, vec(p.muted));
  ImGui::TextUnformatted(right.c_str());
  ImGui::PopStyleColor();
}

void App::after_drawing() {
  if (const auto request = traces_.take_picture_request()) {
    attempt([&] {
      io::write_file_atomically(request->path,
                                png(window_.pixels(request->left, request->top, request->right, request->bottom)));
    });
  }
  if (std::exchange(picture_wanted_, false)) {
    attempt([&] {
      io::write_file_atomically("handloop_panel.png", png(window_.pixels()));
      bench_.say("saved handloop_panel.png");
    });
  }
  if (!options_.describe || bench_.now_s - last_described_s_ < 0.1) return;
  last_described_s_ = bench_.now_s;
  auto text = description_of(bench_, Landmarks::all());
  if (text == described_) return;
  io::write_file_atomically(*options_.describe, text);
  described_ = std::move(text);
}

}  // namespace handloop::ui
