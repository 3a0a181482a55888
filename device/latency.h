#pragma once

#include <array>
#include <cstdint>

namespace handloop::device {

/// Counts durations in classes 1/32 of an octave wide (3 % apart), from 1 ns to 70 s, in constant memory: percentiles
/// of a run of any length. add() is real-time safe.
class LatencyHistogram {
 public:
  void add(std::int64_t duration_ns) noexcept;
  std::uint64_t count() const noexcept { return count_; }
  /// Duration in microseconds that `share` (0..1) of the values do not exceed, to within a class: its upper end, but
  /// never more than the largest value. 0 where nothing was counted.
  double percentile_us(double share) const noexcept;
  double max_us() const noexcept { return static_cast<double>(max_ns_) * 1e-3; }
  double mean_us() const noexcept;

 private:
  static constexpr int kPerOctave = 32;
  static constexpr int kOctaves = 37;
  std::array<std::uint64_t, kPerOctave * kOctaves> classes_{};
  std::uint64_t count_ = 0;
  std::int64_t max_ns_ = 0;
  double sum_ns_ = 0.0;
};

}  // namespace handloop::device
