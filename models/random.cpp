#include "models/random.h"

#include <Random123/philox.h>

#include <cmath>
#include <numbers>

namespace handloop::models {

std::array<std::uint64_t, 4> CounterRandom::bits(std::uint64_t index, std::uint64_t block) const {
  const r123::Philox4x64::ctr_type counter{{index, block, stream_, 0}};
  const r123::Philox4x64::key_type key{{seed_, 0}};
  const auto result = r123::Philox4x64{}(counter, key);
  return {result[0], result[1], result[2], result[3]};
}

std::array<double, 4> CounterRandom::uniforms(std::uint64_t index, std::uint64_t block) const {
  std::array<double, 4> values{};
  const auto raw = bits(index, block);
  for (std::size_t i = 0; i < 4; ++i) {
    // The half keeps 0 and 1 out: quantiles and logarithms stay finite. One bit is given up for it.
    values[i] = (static_cast<double>(raw[i] >> 12) + 0.5) * 0x1p-52;
  }
  return values;
}

double CounterRandom::normal(std::uint64_t index) const {
  const auto u = uniforms(index);
  return std::sqrt(-2 * std::log(u[0])) * std::cos(2 * std::numbers::pi * u[1]);
}

}  // namespace handloop::models
