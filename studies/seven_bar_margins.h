#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "control/transfer_loop.h"

/// Stability of Kazerooni and Her's seven-bar interface ("The dynamics and control of a haptic interface device", IEEE
/// Trans. Robotics and Automation 10(4), 1994): the loop G K (alpha H0 + E0) of the hand, the inner position loop and
/// the filter.
namespace handloop::studies {

/// G = (1.2516 s + 2.079)/(0.002 s^3 + s^2 + 1.2516 s + 2.079), H0 = 4.0418 s^2 + 34.761 s + 176.586 N/m (their 12.1
/// lbf/ft in SI) and E0 = 9.08 s^2. The paper does not give K; K = k/(0.03 s + 1)^3 m/N with k = 0.0198 is ours, chosen
/// so that alpha = 5 and 8 are stable and 19 is not, as in its experiment. S_h = S_e = 0.
control::TransferLoop seven_bar_loop(double alpha, double filter_gain = 0.0198);

struct SevenBarMargins {
  struct Entry {
    double alpha;
    control::TransferMargins result;
  };
  std::vector<Entry> loops;  ///< alpha of the paper: 8 (x), 5 (y) and the unstable 19
  double alpha_limit = 0.0;  ///< stable below
  double filter_gain = 0.0198;
};
SevenBarMargins seven_bar_margins();

nlohmann::ordered_json to_json(const SevenBarMargins& result);
std::string to_text(const SevenBarMargins& result);

}  // namespace handloop::studies
