#pragma once

#include <sys/types.h>

#include <atomic>
#include <cstdint>
#include <functional>

namespace handloop::device::comedi {

/// A second process that zeroes the motors when the first cannot: DACs hold their last voltage for ever, also after a
/// kill -9, a crash or a debugger's breakpoint. It watches a heartbeat in shared memory and the life of its parent.
class Guardian {
 public:
  /// Forks. `zero` is called in the child, again and again, whenever the heartbeat has been missing for `watchdog_s` or
  /// the parent is gone; it must only use what survives a fork (open descriptors, no locks). Throws InputError where no
  /// process can be made.
  Guardian(double watchdog_s, std::function<bool()> zero);
  /// The child ends without zeroing: whoever ends in order has done so.
  ~Guardian();
  Guardian(const Guardian&) = delete;
  Guardian& operator=(const Guardian&) = delete;

  /// The controller lives. Real-time safe.
  void beat() noexcept { state_->beats.fetch_add(1, std::memory_order_relaxed); }
  /// How often the guardian had to step in.
  std::uint64_t interventions() const noexcept { return state_->interventions.load(std::memory_order_relaxed); }
  pid_t process() const noexcept { return child_; }

 private:
  struct Shared {
    std::atomic<std::uint64_t> beats;
    std::atomic<std::uint64_t> interventions;
  };
  static_assert(std::atomic<std::uint64_t>::is_always_lock_free);
  [[noreturn]] void watch(int pipe, double watchdog_s, const std::function<bool()>& zero);

  Shared* state_ = nullptr;
  int pipe_ = -1;
  pid_t child_ = -1;
};

}  // namespace handloop::device::comedi
