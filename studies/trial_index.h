#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "models/arm.h"
#include "models/axis.h"

namespace handloop::studies {

/// One recording of a set: what an index says of it.
struct IndexedTrial {
  int trial = 0;
  int subject = 0;  ///< 0: not known
  int grip = 0;     ///< nominal grip force in N; 0: not known
  std::optional<models::Axis> axis;
  std::filesystem::path file;
  std::optional<models::ArmParameters> truth;  ///< where the recording was simulated and the index gives the arm
};

/// Reads index.csv as `experiment` writes it: `trial,subject,grip,axis` and, where known, the true parameters. The
/// recording of trial N is trial_00N.csv beside the index, or what a column `file` names. Throws InputError naming the
/// line.
std::vector<IndexedTrial> read_trial_index(const std::filesystem::path& index);

}  // namespace handloop::studies
