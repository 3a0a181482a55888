#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "studies/sweep_plan.h"
#include "studies/sweep_store.h"

namespace handloop::studies {

/// What changed at one point between two sweeps.
struct PointChange {
  SweepCondition condition;
  SweepPoint point;  ///< as in the new sweep
  std::uint64_t old_stable = 0, old_arms = 0, new_stable = 0, new_arms = 0;
  bool paired = false;              ///< the same arms in both: each was compared with itself
  std::uint64_t lost = 0, won = 0;  ///< paired: arms that became unstable, and stable
  double p_value = 1.0;             ///< McNemar where paired, else Fisher; two-sided
  double adjusted_p = 1.0;          ///< Holm's correction for all the points compared
  double old_disk_p05 = Evaluation::kNone, new_disk_p05 = Evaluation::kNone;

  bool significant() const { return adjusted_p < 0.05; }
  double difference() const;  ///< of the shares of stable arms, new less old
};

struct SweepComparison {
  std::string old_name;
  std::vector<std::string> settings;  ///< "delays: 1 -> 2", of everything that differs
  std::vector<PointChange> changes;   ///< of every point that both have, in the new one's order
  std::size_t only_old = 0, only_new = 0;

  std::size_t regressions() const;  ///< points where significantly fewer arms are stable
  std::size_t improvements() const;
  std::string text() const;
};

/// Compares point by point: the same axis, delay, device and gains. Arms are taken as paired where both sweeps drew the
/// same sample (seed, reading, number) and kept their evaluations.
SweepComparison compare_sweeps(SweepStore& old_sweep, SweepStore& new_sweep);

/// The database meant by a person: a file, or a folder with sweep.sqlite in it.
std::filesystem::path sweep_database_path(const std::filesystem::path& given);

}  // namespace handloop::studies
