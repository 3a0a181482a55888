#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <memory>
#include <type_traits>

namespace handloop::device {

/// First in, first out, between exactly one producing and one consuming thread, without locks. The loop pushes, the log
/// or the panel pops. A full ring refuses and counts: the loop never waits for a reader.
/// Allocates at construction only; push() and pop() are real-time safe. Capacity is a power of two.
template <typename T, std::size_t Capacity>
class RingBuffer {
  static_assert((Capacity & (Capacity - 1)) == 0 && Capacity > 1, "the capacity must be a power of two");
  static_assert(std::is_trivially_copyable_v<T> || std::is_copy_assignable_v<T>);

 public:
  RingBuffer() : slots_(std::make_unique<std::array<T, Capacity>>()) {}

  /// Producer. False where the ring was full; the value is then lost and counted.
  bool push(const T& value) noexcept {
    const std::size_t tail = tail_.load(std::memory_order_relaxed);
    if (tail - head_.load(std::memory_order_acquire) == Capacity) {
      lost_.fetch_add(1, std::memory_order_relaxed);
      return false;
    }
    (*slots_)[tail & (Capacity - 1)] = value;
    tail_.store(tail + 1, std::memory_order_release);
    return true;
  }

  /// Consumer. False where nothing waits.
  bool pop(T& value) noexcept {
    const std::size_t head = head_.load(std::memory_order_relaxed);
    if (head == tail_.load(std::memory_order_acquire)) return false;
    value = (*slots_)[head & (Capacity - 1)];
    head_.store(head + 1, std::memory_order_release);
    return true;
  }

  /// Values waiting, as seen by either thread; the other may be changing it.
  std::size_t size() const noexcept {
    return tail_.load(std::memory_order_acquire) - head_.load(std::memory_order_acquire);
  }
  static constexpr std::size_t capacity() noexcept { return Capacity; }
  std::size_t lost() const noexcept { return lost_.load(std::memory_order_relaxed); }

 private:
  // Each index on a cache line of its own: the two threads then do not disturb each other.
  alignas(64) std::atomic<std::size_t> head_{0};
  alignas(64) std::atomic<std::size_t> tail_{0};
  alignas(64) std::atomic<std::size_t> lost_{0};
  std::unique_ptr<std::array<T, Capacity>> slots_;
};

}  // namespace handloop::device
