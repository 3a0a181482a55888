#pragma once

#include <cstddef>
#include <vector>

#include "device/record.h"

namespace handloop::device {

/// The last records of a run, oldest first: the evidence of a fault. Allocates at construction only.
class BlackBox {
 public:
  /// Holds `seconds` of samples.
  BlackBox(double seconds, double sample_time_s)
      : slots_(static_cast<std::size_t>(seconds / sample_time_s) + 1), count_(0) {}

  /// Real-time safe.
  void add(const StepRecord& record) noexcept { slots_[count_++ % slots_.size()] = record; }

  std::size_t size() const noexcept { return count_ < slots_.size() ? count_ : slots_.size(); }
  /// Record `index`, 0 the oldest still held.
  const StepRecord& operator[](std::size_t index) const noexcept {
    return slots_[(count_ - size() + index) % slots_.size()];
  }

 private:
  std::vector<StepRecord> slots_;
  std::size_t count_;
};

}  // namespace handloop::device
