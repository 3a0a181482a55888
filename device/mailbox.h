#pragma once

#include <array>
#include <atomic>

namespace handloop::device {

/// Holds the latest value between exactly one posting and one taking thread, without locks (three slots that change
/// hands). The panel posts gains, the loop takes the newest; what was not taken in time is replaced. Real-time safe on
/// both sides.
template <typename T>
class Mailbox {
 public:
  Mailbox() = default;

  /// Poster.
  void post(const T& value) noexcept {
    slots_[writing_] = value;
    writing_ = middle_.exchange(writing_ | kFresh, std::memory_order_acq_rel) & kIndex;
  }

  /// Taker. False, and `value` untouched, where nothing new was posted.
  bool take(T& value) noexcept {
    if ((middle_.load(std::memory_order_relaxed) & kFresh) == 0) return false;
    reading_ = middle_.exchange(reading_, std::memory_order_acq_rel) & kIndex;
    value = slots_[reading_];
    return true;
  }

 private:
  static constexpr unsigned kFresh = 4, kIndex = 3;
  std::array<T, 3> slots_{};
  alignas(64) unsigned writing_ = 0;
  alignas(64) std::atomic<unsigned> middle_{1};
  alignas(64) unsigned reading_ = 2;
};

}  // namespace handloop::device
