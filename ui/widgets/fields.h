#pragma once

#include <string>

namespace handloop::ui {

/// What a person did to a field in this frame.
struct Edited {
  bool changed = false;   ///< the value is another now
  bool finished = false;  ///< the gesture is over
};

/// A slider with its name on the left and, after Ctrl and a click or Enter, a number to type. `format` as printf's.
/// `name` is the landmark "control.NAME" too.
Edited value_slider(const std::string& name, const char* label, double& value, double low, double high,
                    const char* format, bool logarithmic = false, const char* hint = nullptr);
Edited whole_slider(const std::string& name, const char* label, int& value, int low, int high, const char* format,
                    const char* hint = nullptr);

/// A push button with landmark "button.NAME"; `chosen` shows it pressed in.
bool push_button(const std::string& name, const char* label, bool chosen = false, float width = 0.0f);

/// A line of text; true when Enter was pressed in it.
bool text_field(const char* id, std::string& text);

/// The tip that explains the last item when the mouse rests on it.
void hint(const char* text);

/// Shows a line of small muted text, wrapped.
void note(const std::string& text);
/// A bold heading with a little room above.
void heading(const char* text);

}  // namespace handloop::ui
