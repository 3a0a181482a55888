#pragma once

#include <array>
#include <cstdint>

/// Random numbers by counter (Philox 4x64 of Random123): number i of a stream is a function of (seed, stream, i) alone,
/// so results never depend on how work is spread over threads or ranks. Real-time safe.
namespace handloop::models {

/// Streams in use. A stream of its own keeps one use from shifting another; add yours here.
enum class RandomStream : std::uint32_t {
  arm_population = 1,
  excitation = 2,
  sensor_noise = 3,
  grip_noise = 4,
  wander = 5,
  trial_order = 6,
  hand_motion = 7,
  bootstrap = 8,
  gain_point = 9,
  test = 99
};

class CounterRandom {
 public:
  /// substream tells apart several uses of one stream (axis, channel, trial).
  CounterRandom(std::uint64_t seed, RandomStream stream, std::uint32_t substream = 0)
      : seed_(seed), stream_(static_cast<std::uint64_t>(stream) << 32 | substream) {}

  /// 256 random bits for an index and a block of it.
  std::array<std::uint64_t, 4> bits(std::uint64_t index, std::uint64_t block = 0) const;
  /// Four numbers uniform in the open interval (0, 1), 52 bits each.
  std::array<double, 4> uniforms(std::uint64_t index, std::uint64_t block = 0) const;
  /// Uniform in the open interval (0, 1).
  double uniform(std::uint64_t index) const { return uniforms(index)[0]; }
  /// Standard normal (Box and Muller).
  double normal(std::uint64_t index) const;

 private:
  std::uint64_t seed_;
  std::uint64_t stream_;
};

}  // namespace handloop::models
