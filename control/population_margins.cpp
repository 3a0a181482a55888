#include "control/population_margins.h"

#include <algorithm>
#include <atomic>
#include <boost/math/distributions/binomial.hpp>
#include <thread>

#include "control/stability_boundary.h"

namespace handloop::control {
namespace {

/// Calls work(i) for every i below count, in several threads.
template <class Work>
void in_parallel(std::size_t count, unsigned threads, Work&& work) {
  if (threads == 0) threads = std::max(1U, std::thread::hardware_concurrency());
  constexpr std::size_t kBatch = 64;
  std::atomic<std::size_t> next{0};
  const auto loop = [&] {
    for (std::size_t begin; (begin = next.fetch_add(kBatch)) < count;) {
      for (std::size_t i = begin; i < std::min(begin + kBatch, count); ++i) work(i);
    }
  };
  std::vector<std::thread> crew;
  for (unsigned i = 1; i < std::min<std::size_t>(threads, count / kBatch + 1); ++i) crew.emplace_back(loop);
  loop();
  for (auto& thread : crew) thread.join();
}

/// Order statistic with `share` of the values below it.
double point(std::vector<double> values, double share) {
  const auto k = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + k, values.end());
  return values[static_cast<std::size_t>(k)];
}

Margins point_of(const std::vector<ArmMargins>& all, double share, double unstable_share) {
  const auto of = [&](auto&& value, double none) {
    std::vector<double> values;
    values.reserve(all.size());
    for (const auto& a : all) values.push_back(a.margins.stable ? value(a.margins) : none);
    return point(std::move(values), share);
  };
  Margins m;
  m.stable = unstable_share < share;
  m.rho = -of([](const Margins& x) { return -x.rho; }, -1.0);
  m.gain_up = of([](const Margins& x) { return x.gain_up; }, 1);
  m.gain_down = -of([](const Margins& x) { return -x.gain_down; }, -1);
  m.phase_deg = of([](const Margins& x) { return std::abs(x.phase_deg); }, 0);
  m.delay_s = of([](const Margins& x) { return x.delay_s; }, 0);
  m.modulus = of([](const Margins& x) { return x.modulus; }, 0);
  m.disk_alpha = of([](const Margins& x) { return x.disk_alpha; }, 0);
  return m;
}

}  // namespace

Share clopper_pearson(std::size_t successes, std::size_t trials, double confidence) {
  Share share{successes, trials, 0, 0, 1};
  if (trials == 0) return share;
  using Binomial = boost::math::binomial_distribution<>;
  const auto n = static_cast<double>(trials), k = static_cast<double>(successes);
  const double tail = 0.5 * (1 - confidence);
  share.estimate = k / n;
  share.low95 = successes == 0 ? 0.0 : Binomial::find_lower_bound_on_p(n, k, tail);
  share.high95 = successes == trials ? 1.0 : Binomial::find_upper_bound_on_p(n, k, tail);
  return share;
}

PopulationMargins population_margins(const models::ArmPopulation& population, const Loop& loop, std::size_t count,
                                     std::uint64_t seed, std::size_t keep, unsigned threads) {
  Loop checked = loop;
  checked.plant.arm = population.sample(seed, 0);
  require_valid(checked);
  std::vector<ArmMargins> all(count);
  in_parallel(count, threads, [&](std::size_t i) {
    auto& entry = all[i];
    entry.index = i;
    entry.arm = population.sample(seed, i);
    LoopPlant plant = loop.plant;
    plant.arm = entry.arm;
    entry.margins = evaluate(sample_plant(plant, loop.timing.sample_time_s), loop.timing, loop.gains);
  });
  PopulationMargins result;
  std::size_t stable = 0;
  result.disk_alpha.reserve(count);
  for (const auto& entry : all) {
    stable += entry.margins.stable;
    result.disk_alpha.push_back(entry.margins.stable ? entry.margins.disk_alpha : 0.0);
  }
  result.stable = clopper_pearson(stable, count);
  if (count == 0) return result;
  result.p05 = point_of(all, 0.05, 1 - result.stable.estimate);
  result.p50 = point_of(all, 0.50, 1 - result.stable.estimate);
  const auto worse = [](const ArmMargins& a, const ArmMargins& b) {
    if (a.margins.stable != b.margins.stable) return b.margins.stable;
    const double left = a.margins.stable ? a.margins.disk_alpha : -a.margins.rho,
                 right = b.margins.stable ? b.margins.disk_alpha : -b.margins.rho;
    return left != right ? left < right : a.index < b.index;
  };
  keep = std::min(keep, count);
  std::partial_sort(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(keep), all.end(), worse);
  result.worst.assign(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(keep));
  return result;
}

double population_permitted_stiffness(const models::ArmPopulation& population, const Loop& loop, std::size_t count,
                                      std::uint64_t seed, double share, unsigned threads) {
  std::vector<double> limit(count);
  in_parallel(count, threads, [&](std::size_t i) {
    LoopPlant plant = loop.plant;
    plant.arm = population.sample(seed, i);
    limit[i] =
        critical_stiffness(sample_plant(plant, loop.timing.sample_time_s), loop.timing, loop.gains.damping_Ns_per_m);
  });
  return point(std::move(limit), 1 - share);
}

}  // namespace handloop::control
