#pragma once

#include <cstdint>

/// Tests that compare counted successes; the interval of one proportion is control::clopper_pearson.
namespace handloop::studies {

/// McNemar's test in its exact form: `lost` pairs changed one way and `won` the other. Two-sided probability of a split
/// at least as uneven were both equally likely; 1 where nothing changed.
double mcnemar_p_value(std::uint64_t lost, std::uint64_t won);

/// Fisher's exact test, two-sided: two independent samples, a of n and b of m.
double fisher_p_value(std::uint64_t a, std::uint64_t n, std::uint64_t b, std::uint64_t m);

}  // namespace handloop::studies
