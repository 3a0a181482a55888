#pragma once

#include <algorithm>
#include <cstdint>

namespace handloop::ui {

/// The stretch of time that the traces show: it follows the newest sample until somebody pauses it, and then stands,
/// to be moved and zoomed. Times in s from the first sample.
class TraceWindow {
 public:
  double low_s() const { return end_s_ - length_s_; }
  double high_s() const { return end_s_; }
  double length_s() const { return length_s_; }
  bool following() const { return following_; }

  void follow(double newest_s) {
    if (following_) end_s_ = std::max(newest_s, length_s_);
  }
  void pause() { following_ = false; }
  void resume() { following_ = true; }

  /// Longer (factor above 1) or shorter about a moment that stays where it is; the newest stays at the right edge while
  /// following.
  void zoom(double factor, double about_s) {
    const double length = std::clamp(length_s_ * factor, kShortest_s, kLongest_s);
    if (!following_) end_s_ = about_s + (end_s_ - about_s) * length / length_s_;
    length_s_ = length;
  }
  /// To the past where positive; whoever looks at the past does not follow.
  void move(double by_s) {
    following_ = false;
    end_s_ -= by_s;
  }

 private:
  static constexpr double kShortest_s = 0.02, kLongest_s = 1100.0;
  double end_s_ = 10.0, length_s_ = 10.0;
  bool following_ = true;
};

}  // namespace handloop::ui
