#pragma once

#include <array>
#include <complex>
#include <cstddef>
#include <optional>

#include "control/loop.h"
#include "models/arm_tables.h"

/// Robustness against the five parameters of the arm themselves: is the loop stable for every arm in a box?
///
/// In terms of the grasp's impedance a = k1 + j w b1 and the arm's c = k2 - w^2 M + j w b2, and with D what the device
/// and the wall oppose to the hand, a pole lies on the axis where 1/a + 1/c = -1/D, that is c = -a D/(a + D). At one
/// frequency a and c fill rectangles, and a Moebius map takes discs to discs: so whether some arm of the box puts a
/// pole there is decided exactly, by cutting the rectangle of a into discs finely enough. Real parametric mu at a
/// frequency, which is NP-hard in general, is here a question in the plane.
namespace handloop::control {

/// Bounds of the five parameters in the order of models::kArmParameterNames.
struct ArmBox {
  std::array<double, 5> low{}, high{};

  models::ArmParameters centre() const;
  /// Stretched about its centre; cut where a parameter would leave what is possible (mass, k1 above zero, others not
  /// below).
  ArmBox scaled(double factor) const;
  /// A corner, bit i of the number choosing high for parameter i.
  models::ArmParameters vertex(unsigned number) const;
};

enum class BoxSet { percent67, percent95, extremes };

/// The box of Table III: its 67 % or 95 % "CI" ends, or minimum to maximum.
ArmBox published_box(models::Axis axis, BoxSet set);

/// Whether every arm of a box keeps the sampled loop stable.
struct BoxCertificate {
  bool certified = false;
  double failed_at_rad_per_s = 0.0;  ///< where the proof got stuck, if it did
  std::size_t discs = 0;             ///< work done
};

/// Proves stability for every arm of the box or gives up. A proof holds for the exact sampled loop: between frequencies
/// by bounds on every slope, and with the images of sampling bounded over the box; given that the arm at the centre is
/// stable, which is checked. Giving up means that the box, or one larger by a few thousandths, holds an unstable arm,
/// or that sampling is too coarse for the images to be bounded. The plant's own arm is not looked at.
BoxCertificate certify(const LoopPlant& device, const LoopTiming& timing, const WallGains& gains, const ArmBox& box);

/// mu of the five real parameters, the box being the unit: the loop is stable for all arms of the box stretched by less
/// than 1/upper, and some arm of it stretched by 1/lower is unstable. Robust where upper < 1.
struct StructuredMu {
  bool centre_stable = false;
  double upper = 0.0, lower = 0.0;
  std::optional<models::ArmParameters> destabilising_arm;  ///< at the stretch 1/lower, on the edge of stability
  double destabilising_frequency_rad_per_s = 0.0;
};
/// Both bounds by bisection; the lower from the corners of the box and a search within it. Stretches up to 64 are
/// tried.
StructuredMu structured_mu(const LoopPlant& device, const LoopTiming& timing, const WallGains& gains,
                           const ArmBox& box);

/// Mapping theorem (Zadeh and Desoer 1963): the values of the characteristic function over the box lie in the convex
/// hull of its values at the 32 corners; stable where the hull leaves out zero at every frequency. Sufficient; on a
/// grid, images left out.
bool mapping_theorem_certifies(const LoopPlant& device, const LoopTiming& timing, const WallGains& gains,
                               const ArmBox& box);

/// Kharitonov's theorem (1978) on the coefficients' ranges. It does not apply as it stands: it needs a polynomial with
/// independent coefficients, and the loop has a delay and coefficients that are products of parameters. What is judged
/// instead is the loop with hold and delay as a first-order Pade approximant and each coefficient free in its range:
/// sufficient for that loop only.
bool kharitonov_certifies(const LoopPlant& device, const LoopTiming& timing, const WallGains& gains, const ArmBox& box);

}  // namespace handloop::control
