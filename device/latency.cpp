#include "device/latency.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace handloop::device {
namespace {

constexpr int kBits = 5;  // 32 classes an octave

// Below 32 each value is its own class; above, the leading bit gives the octave and the next five the class in it.
std::size_t class_of(std::uint64_t value) {
  if (value < 32) return value;
  const int octave = static_cast<int>(std::bit_width(value)) - 1 - kBits;
  return static_cast<std::size_t>(octave + 1) * 32 + ((value >> octave) - 32);
}

std::uint64_t upper_end(std::size_t index) {
  if (index < 32) return index;
  const std::size_t octave = index / 32 - 1;
  return ((index % 32 + 33) << octave) - 1;
}

}  // namespace

void LatencyHistogram::add(std::int64_t duration_ns) noexcept {
  const std::int64_t value = std::max<std::int64_t>(duration_ns, 0);
  ++classes_[std::min(class_of(static_cast<std::uint64_t>(value)), classes_.size() - 1)];
  ++count_;
  max_ns_ = std::max(max_ns_, value);
  sum_ns_ += static_cast<double>(value);
}

double LatencyHistogram::percentile_us(double share) const noexcept {
  if (count_ == 0) return 0.0;
  const auto wanted = static_cast<std::uint64_t>(std::ceil(std::clamp(share, 0.0, 1.0) * static_cast<double>(count_)));
  std::uint64_t seen = 0;
  for (std::size_t i = 0; i < classes_.size(); ++i) {
    seen += classes_[i];
    if (seen >= std::max<std::uint64_t>(wanted, 1)) {
      return std::min(static_cast<double>(upper_end(i)), static_cast<double>(max_ns_)) * 1e-3;
    }
  }
  return max_us();
}

double LatencyHistogram::mean_us() const noexcept {
  return count_ == 0 ? 0.0 : sum_ns_ / static_cast<double>(count_) * 1e-3;
}

}  // namespace handloop::device
