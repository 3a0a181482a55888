#include "studies/sweep_statistics.h"

#include <algorithm>
#include <cmath>

namespace handloop::studies {
namespace {

constexpr double kUnstable = -1;  // below every margin

/// The k-th smallest, k = ceil(p n), counted from 1.
double quantile(std::span<double> values, double p) {
  const auto n = static_cast<double>(values.size());
  const auto k = static_cast<std::ptrdiff_t>(std::clamp(std::ceil(p * n - 1e-9), 1.0, n)) - 1;
  std::nth_element(values.begin(), values.begin() + k, values.end());
  return values[static_cast<std::size_t>(k)];
}

}  // namespace

PointStatistics summarise(std::span<const Evaluation> arms, std::span<double> scratch) {
  PointStatistics s;
  s.arms = arms.size();
  if (arms.empty()) return s;
  bool margins_known = false;
  for (const Evaluation& e : arms) {
    s.stable += e.stable > 0.5;
    margins_known = margins_known || !std::isnan(e.sm);
  }
  const std::span<double> values = scratch.first(arms.size());
  for (std::size_t i = 0; i < arms.size(); ++i) values[i] = arms[i].rho;
  s.rho_p95 = quantile(values, 0.95);
  if (!margins_known) return s;
  constexpr std::array<double Evaluation::*, 5> kFields{&Evaluation::gm_up, &Evaluation::pm_deg, &Evaluation::dm_s,
                                                        &Evaluation::sm, &Evaluation::disk_alpha};
  for (std::size_t m = 0; m < kFields.size(); ++m) {
    for (std::size_t i = 0; i < arms.size(); ++i)
      values[i] = arms[i].stable > 0.5 ? std::abs(arms[i].*kFields[m]) : kUnstable;
    const auto known = [](double value) { return value == kUnstable ? Evaluation::kNone : value; };
    s.margins[m].p50 = known(quantile(values, 0.5));
    s.margins[m].p05 = known(quantile(values, 0.05));
    s.margins[m].min = known(*std::min_element(values.begin(), values.end()));
  }
  return s;
}

}  // namespace handloop::studies
