#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

namespace handloop::ui {

/// Smallest and largest of a stretch of samples; NaN counts for nothing.
struct MinMax {
  float low = std::numeric_limits<float>::infinity();
  float high = -std::numeric_limits<float>::infinity();

  bool empty() const { return low > high; }
  void add(float value) { low = std::fmin(low, value), high = std::fmax(high, value); }
  void add(const MinMax& other) { low = std::min(low, other.low), high = std::max(high, other.high); }
};

/// The last 2^20 samples of one channel with the extremes of every 16, 256, 4096 and 65536 beside them, so that a pixel
/// that stands for any number of samples costs about 60 look-ups at most: a million points draw as fast as a thousand.
/// Samples are numbered from 0 for ever. Memory grows with use.
class MinMaxRing {
 public:
  static constexpr std::uint64_t kCapacity = std::uint64_t{1} << 20;

  void add(float value) {
    put(samples_, kCapacity, count_, value);
    for (std::size_t level = 0; level < kLevels; ++level) {
      const int shift = kShift * static_cast<int>(level + 1);
      const std::uint64_t index = count_ >> shift;
      const std::uint64_t size = kCapacity >> shift;
      if ((count_ & ((std::uint64_t{1} << shift) - 1)) == 0) put(extremes_[level], size, index, MinMax{});
      extremes_[level][index % size].add(value);
    }
    ++count_;
  }
  void clear() {
    samples_.clear();
    for (auto& level : extremes_) level.clear();
    count_ = 0;
  }

  /// Samples ever added, and the oldest still held.
  std::uint64_t count() const { return count_; }
  std::uint64_t first() const { return count_ > kCapacity ? count_ - kCapacity : 0; }
  float operator[](std::uint64_t sample) const { return samples_[sample % kCapacity]; }

  /// Extremes of samples from to to - 1, as far as they are held.
  MinMax extremes(std::uint64_t from, std::uint64_t to) const {
    // a block of which the oldest samples are gone is told from its samples
    from = std::max(from, first());
    to = std::min(to, count_);
    MinMax result;
    while (from < to) {
      std::size_t level = kLevels;
      while (level > 0) {
        const std::uint64_t size = std::uint64_t{1} << (kShift * static_cast<int>(level));
        if (from % size == 0 && from + size <= to) break;
        --level;
      }
      if (level == 0) {
        result.add((*this)[from++]);
      } else {
        const int shift = kShift * static_cast<int>(level);
        result.add(extremes_[level - 1][(from >> shift) % (kCapacity >> shift)]);
        from += std::uint64_t{1} << shift;
      }
    }
    return result;
  }

 private:
  static constexpr int kShift = 4;
  static constexpr std::size_t kLevels = 4;

  template <typename T>
  static void put(std::vector<T>& ring, std::uint64_t size, std::uint64_t index, T value) {
    if (index < size && ring.size() <= index) {
      ring.push_back(value);
    } else {
      ring[index % size] = value;
    }
  }

  std::vector<float> samples_;
  std::array<std::vector<MinMax>, kLevels> extremes_;
  std::uint64_t count_ = 0;
};

}  // namespace handloop::ui
