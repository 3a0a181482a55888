#pragma once

#include <cstdint>
#include <vector>

#include "control/margins.h"
#include "models/arm_population.h"

/// Margins over a population of arms: how likely a wall is stable for the next hand that takes the stylus.
namespace handloop::control {

/// A share of n trials with its Clopper-Pearson interval, which holds at least 95 % of the time whatever the share is.
struct Share {
  std::size_t successes = 0, trials = 0;
  double estimate = 0.0;
  double low95 = 0.0, high95 = 1.0;
};
Share clopper_pearson(std::size_t successes, std::size_t trials, double confidence = 0.95);

struct ArmMargins {
  std::uint64_t index = 0;  ///< of the arm in the population's sequence for the seed
  models::ArmParameters arm;
  Margins margins;
};

struct PopulationMargins {
  Share stable;
  /// The value of each margin that 5 % of all arms fall below (gain_down: rise above), unstable arms counted as having
  /// none: gain factor 1, phase, delay, modulus and alpha 0. `stable` says whether fewer than 5 % are unstable.
  Margins p05;
  Margins p50;                     ///< the same for half of the arms
  std::vector<ArmMargins> worst;   ///< unstable ones first, by rho; then by disk margin
  std::vector<double> disk_alpha;  ///< of every arm in order, 0 where unstable
};

/// Draws `count` arms and judges each, in `threads` threads (0: all cores); the same for any number of threads. The
/// plant's own arm is replaced. Keeps the `keep` worst arms.
PopulationMargins population_margins(const models::ArmPopulation& population, const Loop& loop, std::size_t count,
                                     std::uint64_t seed, std::size_t keep = 5, unsigned threads = 0);

/// Largest K of this B at which at least this share of the same arms is stable (each arm by its own K_cr).
double population_permitted_stiffness(const models::ArmPopulation& population, const Loop& loop, std::size_t count,
                                      std::uint64_t seed, double share, unsigned threads = 0);

}  // namespace handloop::control
