#pragma once

#include <cstdint>

/// Statistics of counted successes.
namespace handloop::studies {

struct ProportionInterval {
  double low = 0.0;
  double high = 1.0;
};

/// Clopper and Pearson (1934): the exact interval of a probability of which `successes` of `trials` were seen; it holds
/// the truth in at least `confidence` of all cases, whatever the truth.
ProportionInterval clopper_pearson(std::uint64_t successes, std::uint64_t trials, double confidence = 0.95);

/// McNemar's test in its exact form: `lost` pairs changed one way and `won` the other. Two-sided probability of a split
/// at least as uneven were both equally likely; 1 where nothing changed.
double mcnemar_p_value(std::uint64_t lost, std::uint64_t won);

/// Fisher's exact test, two-sided: two independent samples, a of n and b of m.
double fisher_p_value(std::uint64_t a, std::uint64_t n, std::uint64_t b, std::uint64_t m);

}  // namespace handloop::studies
