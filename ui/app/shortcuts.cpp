#include "ui/app/shortcuts.h"

#include <GLFW/glfw3.h>

namespace handloop::ui {

const std::vector<Shortcut>& shortcuts() {
  static const std::vector<Shortcut> kShortcuts{
      {Command::stop, GLFW_KEY_ESCAPE, 0, "Esc", "Stop: the force goes to zero", true},
      {Command::undo, GLFW_KEY_Z, GLFW_MOD_CONTROL, "Ctrl+Z", "Undo", false},
      {Command::redo, GLFW_KEY_Y, GLFW_MOD_CONTROL, "Ctrl+Y", "Redo", false},
      {Command::redo, GLFW_KEY_Z, GLFW_MOD_CONTROL | GLFW_MOD_SHIFT, "Ctrl+Shift+Z", "Redo", false},
      {Command::open, GLFW_KEY_O, GLFW_MOD_CONTROL, "Ctrl+O", "Open a scenario", true},
      {Command::save, GLFW_KEY_S, GLFW_MOD_CONTROL, "Ctrl+S", "Save the scenario", true},
      {Command::save_as, GLFW_KEY_S, GLFW_MOD_CONTROL | GLFW_MOD_SHIFT, "Ctrl+Shift+S", "Save under another name",
       true},
      {Command::pause, GLFW_KEY_P, GLFW_MOD_CONTROL, "Ctrl+P", "Pause the simulation and go on", true},
      {Command::single_step, GLFW_KEY_PERIOD, GLFW_MOD_CONTROL, "Ctrl+.", "One sample further", true},
      {Command::reset, GLFW_KEY_F5, 0, "F5", "Start the simulation anew; clears a fault", true},
      {Command::larger, GLFW_KEY_EQUAL, GLFW_MOD_CONTROL, "Ctrl+=", "Larger", true},
      {Command::smaller, GLFW_KEY_MINUS, GLFW_MOD_CONTROL, "Ctrl+-", "Smaller", true},
      {Command::theme, GLFW_KEY_T, GLFW_MOD_CONTROL, "Ctrl+T", "Dark or light", true},
      {Command::view_tune, GLFW_KEY_1, GLFW_MOD_CONTROL, "Ctrl+1", "Tune", true},
      {Command::view_arms, GLFW_KEY_2, GLFW_MOD_CONTROL, "Ctrl+2", "Arms", true},
      {Command::view_subject, GLFW_KEY_3, GLFW_MOD_CONTROL, "Ctrl+3", "Subject's display", true},
      {Command::view_data, GLFW_KEY_4, GLFW_MOD_CONTROL, "Ctrl+4", "Data", true},
      {Command::view_traces, GLFW_KEY_5, GLFW_MOD_CONTROL, "Ctrl+5", "Traces", true},
      {Command::view_device, GLFW_KEY_6, GLFW_MOD_CONTROL, "Ctrl+6", "Device", true},
      {Command::picture, GLFW_KEY_F12, 0, "F12", "Save what is shown as handloop_panel.png", true},
      {Command::quit, GLFW_KEY_Q, GLFW_MOD_CONTROL, "Ctrl+Q", "Quit", true},
  };
  return kShortcuts;
}

std::vector<Command> commands_of(const std::vector<KeyPress>& keys, bool typing) {
  constexpr int kMatter = GLFW_MOD_CONTROL | GLFW_MOD_SHIFT | GLFW_MOD_ALT;
  std::vector<Command> commands;
  for (const auto& press : keys) {
    for (const auto& shortcut : shortcuts()) {
      // Escape stops whatever is held down with it
      const bool held = shortcut.command == Command::stop || (press.modifiers & kMatter) == shortcut.modifiers;
      if (press.key == shortcut.key && held && (!typing || shortcut.while_typing)) commands.push_back(shortcut.command);
    }
  }
  return commands;
}

}  // namespace handloop::ui
