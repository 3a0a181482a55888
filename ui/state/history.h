#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace handloop::ui {

/// A value with its past: every edit can be undone. Edits of one gesture (dragging a slider) share a name and become
/// one step until seal() is called.
template <typename Value>
class History {
 public:
  explicit History(Value initial) : steps_{{std::move(initial), ""}} {}

  const Value& now() const { return steps_[at_].value; }

  /// Puts a new value in force. The redo steps end; an unsealed step of the same name is replaced.
  void edit(Value value, const std::string& name) {
    steps_.resize(at_ + 1);
    if (!sealed_ && at_ > 0 && steps_[at_].name == name) {
      steps_[at_].value = std::move(value);
      return;
    }
    steps_.push_back({std::move(value), name});
    if (steps_.size() > kMost) steps_.erase(steps_.begin());
    at_ = steps_.size() - 1;
    sealed_ = false;
  }
  /// The gesture is over: the next edit is a step of its own.
  void seal() { sealed_ = true; }

  bool can_undo() const { return at_ > 0; }
  bool can_redo() const { return at_ + 1 < steps_.size(); }
  /// What undo() would take back, and redo() bring again.
  const std::string& undo_name() const { return steps_[at_].name; }
  const std::string& redo_name() const { return steps_[at_ + 1].name; }
  bool undo() { return move(can_undo(), -1); }
  bool redo() { return move(can_redo(), 1); }
  /// A new beginning: nothing to undo.
  void restart(Value value) {
    steps_.assign(1, {std::move(value), ""});
    at_ = 0;
    sealed_ = true;
  }

 private:
  struct Step {
    Value value;
    std::string name;
  };
  static constexpr std::size_t kMost = 500;

  bool move(bool possible, std::ptrdiff_t by) {
    if (possible) at_ = static_cast<std::size_t>(static_cast<std::ptrdiff_t>(at_) + by);
    sealed_ = true;
    return possible;
  }

  std::vector<Step> steps_;
  std::size_t at_ = 0;
  bool sealed_ = true;
};

}  // namespace handloop::ui
