#include "identify/fourier.h"

#include <algorithm>
#include <cmath>
#include <kissfft.hh>
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

struct PairTransform::Workspace {
  explicit Workspace(std::size_t length) : plan(length, false), in(length), out(length) {}
  kissfft<double> plan;
  std::vector<Complex> in, out;
};

PairTransform::PairTransform(std::size_t length) : length_(length) {
  if (length == 0) throw std::invalid_argument("a transform needs at least one sample");
  work_ = std::make_unique<Workspace>(length);
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
  work_->plan.transform(work_->in.data(), work_->out.data());
  for (std::size_t k = 0; k < X.size(); ++k) {
    const Complex here = work_->out[k];
    const Complex mirror = std::conj(work_->out[k == 0 ? 0 : length_ - k]);
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
