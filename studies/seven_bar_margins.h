#pragma once

#include <array>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "control/force_control_primary.h"
#include "control/transfer_loop.h"
#include "models/scenario.h"

/// Stability and performance of Kazerooni and Her's interface ("The dynamics and control of a haptic interface device",
/// IEEE Trans. Robotics and Automation 10(4), 1994) as a scenario has it.
namespace handloop::studies {

/// What of it is ours, in one line, for everything that shows a number.
extern const char* const kSevenBarAssumption;

/// The loop as the paper has it: G (17), H_0 (18), E_0 (19), S_h = S_e = 0, and K = k/(0.03 s + 1)^3 of ours.
control::TransferLoop seven_bar_loop(double alpha, double filter_gain = 0.0198);

struct SevenBarMargins {
  struct Entry {
    double alpha;
    control::TransferMargins result;
  };
  /// Along x, then y.
  struct Axis {
    std::optional<control::TransferMargins> loop;  ///< G K (alpha H_0 + E), S = 0; none where alpha couples the axes
    double environment_kg = 0.0;                   ///< of the mechanism's E = this s^2; the paper prints 9.08
    std::optional<control::Limit> ideal;           ///< largest alpha with S_h = S_e = 0
    std::optional<control::Limit> modelled;        ///< with the S_h, S_e and delays of the primary controller
  };
  std::vector<Entry> printed;  ///< the paper's loop at its alpha: 8 (x), 5 (y) and the unstable 19
  double alpha_limit = 0.0;    ///< of the paper's loop: stable below
  std::array<Axis, 2> axes;
  std::optional<control::Limit> together;  ///< factor of the whole alpha, both axes at once, S_h and S_e included
  bool stable = false;                     ///< of the scenario's loop: G_c has its poles in the left half, and so has
                                           ///< alpha room left with S_h and S_e
  control::Performance performance;        ///< (8) and (9)
  double band_rad_per_s = 0.0, epsilon = 0.0;
  control::SmallGain small_gain;        ///< (15)
  double nonlinear_gain_N_per_m = 0.0;  ///< lambda_Delta of the scenario's cubic spring within its workspace
};
/// Of a scenario, at its pose; milliseconds. Throws InputError for a pose without one.
SevenBarMargins seven_bar_margins(const models::Scenario& scenario);

nlohmann::ordered_json to_json(const SevenBarMargins& result);
std::string to_text(const SevenBarMargins& result);

}  // namespace handloop::studies
