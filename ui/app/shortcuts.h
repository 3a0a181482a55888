#pragma once

#include <string>
#include <vector>

#include "ui/app/window.h"

namespace handloop::ui {

enum class Command {
  stop,
  undo,
  redo,
  open,
  save,
  save_as,
  pause,
  single_step,
  reset,
  larger,
  smaller,
  theme,
  view_tune,
  view_arms,
  view_subject,
  view_data,
  view_traces,
  view_device,
  picture,
  quit
};

struct Shortcut {
  Command command;
  int key, modifiers;  ///< as GLFW numbers them
  std::string keys;    ///< as people read them
  std::string meaning;
  bool while_typing;  ///< works while a text field has the keyboard too
};
const std::vector<Shortcut>& shortcuts();

/// Commands of the keys that were pressed, in order.
std::vector<Command> commands_of(const std::vector<KeyPress>& keys, bool typing);

}  // namespace handloop::ui
