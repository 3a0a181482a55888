#include "control/closed_loop_verdict.h"

#include <cmath>
#include <string>

#include "control/polynomial.h"
#include "models/errors.h"

namespace handloop::control {
namespace {

using Poly = Polynomial<24>;

/// A polynomial in delta of given degree, times (1 - w)^degree, as a polynomial in w: delta = 2 w/(1 - w).
Poly in_w(const Poly& in_delta, int degree) {
  Poly minus;  // 1 - w
  minus.degree = 1, minus.c[0] = 1, minus.c[1] = -1;
  Poly two;  // 2 w
  two.degree = 1, two.c[1] = 2;
  Poly sum, power;  // (2 w)^i (1 - w)^(degree - i)
  power.c[0] = 1;
  for (int i = 0; i <= degree; ++i) {
    Poly term = i <= in_delta.degree ? in_delta.c[static_cast<std::size_t>(i)] * power : Poly{};
    for (int k = i; k < degree; ++k) term = term * minus;
    sum = sum + term;
    power = power * two;
  }
  sum.degree = degree;
  return sum;
}

}  // namespace

ClosedLoopVerdict::ClosedLoopVerdict(const SampledPlant& plant, const LoopTiming& timing) {
  require_valid(timing);
  if (timing.delay_samples > kMaxDelay) {
    throw InputError("delay_samples = " + std::to_string(timing.delay_samples) +
                     ": a verdict by Routh's test takes at most " + std::to_string(kMaxDelay));
  }
  const double one_minus_a = -std::expm1(-2 * std::numbers::pi * timing.cutoff_Hz * timing.sample_time_s);
  Poly numerator;
  numerator.degree = plant.section_count == 2 ? 3 : 1;
  std::copy(plant.numerator.begin(), plant.numerator.end(), numerator.c.begin());
  Poly filter;
  filter.degree = 1, filter.c[0] = one_minus_a, filter.c[1] = 1;
  // the filter's pole and the plant's in factors, each well conditioned in w
  Poly open = in_w(filter, 1);
  for (int i = 0; i < plant.section_count; ++i) {
    Poly section;
    section.degree = 2;
    section.c[0] = plant.sections[static_cast<std::size_t>(i)].a0;
    section.c[1] = plant.sections[static_cast<std::size_t>(i)].a1;
    section.c[2] = 1;
    open = open * in_w(section, 2);
  }
  Poly z;  // 1 + delta = (1 + w)/(1 - w)
  z.degree = 1, z.c[0] = z.c[1] = 1;
  for (int i = 0; i < timing.delay_samples; ++i) open = open * z;
  degree_ = open.degree;
  const Poly stiffness = in_w(numerator * filter, degree_);
  const Poly damping = in_w((one_minus_a / timing.sample_time_s) * numerator.shifted(), degree_);
  for (std::size_t i = 0; i <= static_cast<std::size_t>(degree_); ++i) {
    open_[i] = open.c[i], stiffness_[i] = stiffness.c[i], damping_[i] = damping.c[i];
  }
}

bool ClosedLoopVerdict::stable(const WallGains& gains) const noexcept {
  const int n = degree_;
  std::array<double, kCapacity> c;
  for (int i = 0; i <= n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    c[k] = open_[k] + gains.stiffness_N_per_m * stiffness_[k] + gains.damping_Ns_per_m * damping_[k];
    if (!(c[k] > 0))
      return false;  // necessary: all of one sign (at w -> infinity that is z = -1, which stays positive)
  }
  // Routh's array, from the highest power, in place: row pairs interleave, so one array shrinks by one each step
  for (int top = n; top >= 2; --top) {
    const double ratio = c[static_cast<std::size_t>(top)] / c[static_cast<std::size_t>(top - 1)];
    for (int i = top - 2; i >= 1; i -= 2) c[static_cast<std::size_t>(i)] -= ratio * c[static_cast<std::size_t>(i - 1)];
    if (!(c[static_cast<std::size_t>(top - 2)] > 0)) return false;
  }
  return true;
}

}  // namespace handloop::control
