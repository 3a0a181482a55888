#include "identify/fourier.h"

#include <algorithm>
#include <cmath>
#include <kissfft.hh>
#include <numbers>
#include <stdexcept>

namespace handloop::identify {

using Complex = std::complex<double>;

std::size_t smooth_length(std::size_t limit) {
  std::size_t best = 0;
  for (std::size_t five = 1; five <= limit; five *= 5) {
    for (std::size_t three = five; three <= limit; three *= 3) {
      std::size_t two = three;
      while (two <= limit / 2) two *= 2;
      best = std::max(best, two);
    }
  }
  return best;
}

namespace {

/// Multiplications a sample of a transform whose length has these prime factors.
double factor_cost(std::size_t length) {
  double cost = 0;
  for (std::size_t p = 2; length > 1; ++p) {
    if (p * p > length) p = length;
    for (; length % p == 0; length /= p) cost += static_cast<double>(p);
  }
  return cost;
}

/// Into how many interleaved parts a transform is best split when only 2 bins + 1 values (both signs) are wanted.
std::size_t best_parts(std::size_t length, std::size_t bins) {
  const double size = static_cast<double>(length), wanted = static_cast<double>(2 * bins + 1);
  std::size_t best = 1;
  double least = size * factor_cost(length) + wanted;
  for (std::size_t parts = 2; parts <= length / 2 && parts <= 128; ++parts) {
    if (length % parts != 0) continue;
    const double cost = size * factor_cost(length / parts) + wanted * static_cast<double>(parts);
    if (cost < least) {
      least = cost;
      best = parts;
    }
  }
  return best;
}

}  // namespace

/// X[k] = sum over r < parts of W^(r k) S_r[k mod length/parts], S_r the transform of the samples r, r + parts, ...;
/// put together by Horner's rule in W^k for k = -(bins-1) .. bins-1.
struct PairTransform::Workspace {
  Workspace(std::size_t length, std::size_t wanted)
      : bins(wanted),
        parts(best_parts(length, wanted)),
        short_length(length / parts),
        plan(short_length, false),
        in(length),
        part(short_length),
        twiddle(2 * wanted - 1),
        total(2 * wanted - 1),
        first(wanted - 1) {
    for (std::size_t j = 0; j < twiddle.size(); ++j) {
      const double k = static_cast<double>(j) - static_cast<double>(first);
      twiddle[j] = std::polar(1.0, -2 * std::numbers::pi * k / static_cast<double>(length));
    }
  }

  void run() {
    std::fill(total.begin(), total.end(), Complex(0));
    // Bin -first of a transform of short_length.
    const std::size_t start = (short_length - first % short_length) % short_length;
    for (std::size_t r = parts; r-- > 0;) {
      plan.transform(in.data() + r, part.data(), 0, 1, parts);
      for (std::size_t j = 0, from = start; j < total.size(); from = 0) {
        const std::size_t stop = std::min(total.size(), j + short_length - from);
        const Complex* const s = part.data() + from - j;
        for (; j < stop; ++j) total[j] = total[j] * twiddle[j] + s[j];
      }
    }
  }

  std::size_t bins, parts, short_length;
  kissfft<double> plan;
  std::vector<Complex> in, part, twiddle, total;
  std::size_t first;  ///< index of bin 0 in `total`
};

PairTransform::PairTransform(std::size_t length, std::size_t bins) : length_(length) {
  if (length == 0) throw std::invalid_argument("a transform needs at least one sample");
  const std::size_t all = length / 2 + 1;
  work_ = std::make_unique<Workspace>(length, bins == 0 ? all : std::min(bins, all));
}
PairTransform::~PairTransform() = default;
PairTransform::PairTransform(PairTransform&&) noexcept = default;
PairTransform& PairTransform::operator=(PairTransform&&) noexcept = default;

void PairTransform::operator()(std::span<const double> x, std::span<const double> y, std::span<Complex> X,
                               std::span<Complex> Y) {
  // Both signals travel in one complex one. The smaller is scaled up (by a power of two, exactly), or the rounding of
  // the larger would drown it: newtons beside tenths of a millimetre.
  double largest_x = 0, largest_y = 0;
  for (std::size_t n = 0; n < length_; ++n) {
    largest_x = std::max(largest_x, std::abs(x[n]));
    largest_y = std::max(largest_y, std::abs(y[n]));
  }
  const bool both = largest_x > 0 && largest_y > 0;
  const double scale = both ? std::exp2(std::round(std::log2(largest_x) - std::log2(largest_y))) : 1.0;
  for (std::size_t n = 0; n < length_; ++n) work_->in[n] = {x[n], scale * y[n]};
  if (X.size() > work_->bins) throw std::invalid_argument("more bins asked for than announced");
  work_->run();
  for (std::size_t k = 0; k < X.size(); ++k) {
    const Complex here = work_->total[work_->first + k];
    const Complex mirror = std::conj(work_->total[work_->first - k]);
    X[k] = 0.5 * (here + mirror);
    Y[k] = Complex(0, -0.5 / scale) * (here - mirror);
  }
}

std::vector<Complex> transform(std::span<const double> x) {
  PairTransform both(x.size());
  std::vector<Complex> X(x.size() / 2 + 1), Y(X.size());
  const std::vector<double> zero(x.size(), 0.0);
  both(x, zero, X, Y);
  return X;
}

}  // namespace handloop::identify
