#include "studies/proportions.h"

#include <algorithm>
#include <boost/math/distributions/binomial.hpp>
#include <boost/math/special_functions/gamma.hpp>
#include <cmath>

namespace handloop::studies {

double mcnemar_p_value(std::uint64_t lost, std::uint64_t won) {
  const std::uint64_t n = lost + won;
  if (n == 0) return 1;
  const boost::math::binomial_distribution<double> fair(static_cast<double>(n), 0.5);
  return std::min(1.0, 2 * boost::math::cdf(fair, static_cast<double>(std::min(lost, won))));
}

double fisher_p_value(std::uint64_t a, std::uint64_t n, std::uint64_t b, std::uint64_t m) {
  const std::uint64_t hits = a + b, low = hits > m ? hits - m : 0, high = std::min(n, hits);
  const auto choose = [](std::uint64_t top, std::uint64_t k) {
    const double t = static_cast<double>(top), j = static_cast<double>(k);
    return boost::math::lgamma(t + 1) - boost::math::lgamma(j + 1) - boost::math::lgamma(t - j + 1);
  };
  const double all = choose(n + m, hits);
  const auto probability = [&](std::uint64_t x) { return std::exp(choose(n, x) + choose(m, hits - x) - all); };
  const double seen = probability(a) * (1 + 1e-7);  // ties count, rounding aside
  double sum = 0;
  for (std::uint64_t x = low; x <= high; ++x)
    if (const double p = probability(x); p <= seen) sum += p;
  return std::min(1.0, sum);
}

}  // namespace handloop::studies
