#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "studies/sweep.h"

namespace handloop::studies {

/// One arm and gain pair near the boundary, judged by the linear loop and by the MuJoCo plant.
struct TruthCase {
  std::uint64_t number = 0;
  models::Axis axis = models::Axis::z;
  double stiffness_N_per_m = 0.0, damping_Ns_per_m = 0.0;
  double share_of_critical = 1.0;  ///< stiffness over the critical one
  double rho = 0.0;                ///< of the linear loop
  bool linear_stable = false;
  bool simulated_stable = false;  ///< with the scenario's electronics and friction
  bool ideal_stable = false;      ///< with ideal electronics and without friction
  /// Where the simulation disagrees: which of these, switched off alone, brings agreement ("" where none does).
  std::string explained_by;

  bool agrees() const { return linear_stable == simulated_stable; }
};

struct TruthCheck {
  std::vector<TruthCase> cases;
  std::size_t agreeing() const;
  std::size_t agreeing_ideal() const;
  std::size_t unexplained() const;  ///< disagreements that no single cause explains
  std::string text() const;
  /// One row a case, with a header.
  std::string csv() const;
};

/// Draws `count` arms of the settings' axes, a damping in the settings' range each, and a stiffness within +-25 % of
/// the critical one (half of them within 5 %). Disagreements are run again with quantisation, saturation, friction and
/// noise switched off one at a time. Throws InputError.
TruthCheck check_truth(const SweepSettings& settings, std::uint64_t count, int jobs, const SweepProgress& progress);

}  // namespace handloop::studies
