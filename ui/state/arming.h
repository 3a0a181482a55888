#pragma once

namespace handloop::ui {

/// Real hardware gets force only after two deliberate actions: a cover that is opened, and a button that is then held.
/// Closing the cover, or letting go too early, starts over. A plain state machine; seconds come from outside.
class Arming {
 public:
  static constexpr double kHold_s = 1.5;
  /// A cover left open closes again by itself.
  static constexpr double kCoverOpen_s = 20.0;

  void open_cover(double now_s) {
    if (!armed_) cover_open_ = true, opened_s_ = now_s, held_since_s_ = -1.0;
  }
  void close_cover() { cover_open_ = false, held_since_s_ = -1.0; }

  /// Once a frame: whether the button is down. True in the frame in which arming is complete.
  bool hold(bool down, double now_s) {
    if (armed_ || !cover_open_) return false;
    if (!down) {
      held_since_s_ = -1.0;
      if (now_s - opened_s_ > kCoverOpen_s) close_cover();
      return false;
    }
    if (held_since_s_ < 0.0) held_since_s_ = now_s;
    if (now_s - held_since_s_ < kHold_s) return false;
    armed_ = true;
    close_cover();
    return true;
  }
  void disarm() {
    armed_ = false;
    close_cover();
  }

  bool armed() const { return armed_; }
  bool cover_open() const { return cover_open_; }
  /// Of the holding, 0 to 1.
  double held_share(double now_s) const {
    if (held_since_s_ < 0.0) return 0.0;
    const double share = (now_s - held_since_s_) / kHold_s;
    return share < 1.0 ? share : 1.0;
  }

 private:
  bool cover_open_ = false, armed_ = false;
  double opened_s_ = 0.0, held_since_s_ = -1.0;
};

}  // namespace handloop::ui
