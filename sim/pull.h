#pragma once

#include <array>

namespace handloop::sim {

/// A spring and damper between the stylus and a point, as somebody who reaches into the scene holds it (MuJoCo's viewer
/// does the same). The sensor at the grip feels it. Stiffness 0: nobody pulls.
struct Pull {
  std::array<double, 3> anchor_m{};  ///< device frame
  double stiffness_N_per_m = 0.0;
  double damping_Ns_per_m = 0.0;
  double limit_N = 4.0;  ///< of the spring's force
};

}  // namespace handloop::sim
