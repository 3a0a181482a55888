#pragma once

#include <string>
#include <vector>

#include "control/stability_boundary.h"
#include "models/arm_population.h"
#include "models/axis.h"

/// K-B stability maps: the boundary of one loop, and how it moves with the delay, the sampling period, the device's
/// damping and each parameter of the arm.
namespace handloop::studies {

/// The boundary for one value of one quantity.
struct BoundaryMember {
  double value = 0.0;
  std::string label;  ///< "2 samples"
  std::vector<control::BoundaryPiece> pieces;
};

struct BoundaryFamily {
  std::string quantity;  ///< "delay_samples", "sample_time_s", "tip_damping_Ns_per_m", or a parameter of the arm
  std::string title;     ///< "Delay"
  std::vector<BoundaryMember> members;
};

/// The boundary of the loop itself is the first family, "nominal". Arm parameters go to their minimum, 5, 50, 95 % and
/// maximum of Table III with the others as they are; friction is the viscous damping of the device, from none to 20
/// times.
std::vector<BoundaryFamily> boundary_families(const control::Loop& loop, const models::ArmPopulation& population,
                                              const control::GainWindow& window);

/// A window that shows where the loop's own stability ends, and the gains themselves.
control::GainWindow natural_window(const control::Loop& loop);

/// `family,value,piece,stiffness_N_per_m,damping_Ns_per_m,frequency_Hz`.
std::string boundaries_csv(const std::vector<BoundaryFamily>& families);

}  // namespace handloop::studies
