#pragma once

#include <complex>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

namespace handloop::identify {

/// The largest length not above `limit` whose only prime factors are 2, 3 and 5: a length the transform handles
/// quickly. 0 for 0.
std::size_t smooth_length(std::size_t limit);

/// Discrete Fourier transforms of two real signals of one length at once (one complex transform serves both).
/// Not to be shared between threads: the workspace belongs to the object.
class PairTransform {
 public:
  /// `bins`: as many as will be asked for, 0 for all length/2 + 1. Where they are few, the transform is split into
  /// several shorter ones and only the wanted bins are put together. Throws std::invalid_argument for length 0.
  explicit PairTransform(std::size_t length, std::size_t bins = 0);
  ~PairTransform();
  PairTransform(PairTransform&&) noexcept;
  PairTransform& operator=(PairTransform&&) noexcept;

  std::size_t length() const { return length_; }

  /// X[k] = sum over n of x[n] exp(-2 pi j k n / length) for k = 0 .. bins-1, and Y alike. `x`, `y` hold `length`
  /// values, `X`, `Y` as many bins as are wanted, at most length/2 + 1 each and the same number. No scaling.
  void operator()(std::span<const double> x, std::span<const double> y, std::span<std::complex<double>> X,
                  std::span<std::complex<double>> Y);

 private:
  struct Workspace;
  std::size_t length_;
  std::unique_ptr<Workspace> work_;
};

/// The bins 0 .. length/2 of one real signal, unscaled.
std::vector<std::complex<double>> transform(std::span<const double> x);

}  // namespace handloop::identify
