#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "sim/arm_axis.h"

namespace handloop::sim {
namespace {

using models::Effect;
using models::Place;
using models::PortBase;
using models::PortMotion;

constexpr double kBriskSpeed_m_per_s = 0.2;

/// Largest slope of the force over a ladder of small and usual motions.
double steepest(const Effect& effect, const PortBase& base, const std::vector<double>& states, bool over_velocity) {
  constexpr std::array kLadder{1e-5, 1e-4, 1e-3, 1e-2};
  double slope = 0;
  for (const double width : kLadder) {
    for (const double middle : {0.0, 3 * width, 10 * width}) {
      PortMotion low, high;
      (over_velocity ? low.v_m_per_s : low.x_m) = middle - width;
      (over_velocity ? high.v_m_per_s : high.x_m) = middle + width;
      const double rise = effect.force_N(high, base, states) - effect.force_N(low, base, states);
      slope = std::max(slope, std::abs(rise) / (2 * width));
    }
  }
  return slope;
}

/// Largest rate of the effect's own states at a brisk motion, by finite differences.
double own_rate(const Effect& effect, const PortBase& base) {
  const auto count = static_cast<Eigen::Index>(effect.state_count());
  if (count == 0) return 0.0;
  PortMotion brisk;
  brisk.v_m_per_s = brisk.delayed_v_m_per_s = kBriskSpeed_m_per_s;
  std::vector<double> states(count, 0.0), rates(count), shifted(count);
  effect.state_rates(brisk, base, states, rates);
  Eigen::MatrixXd jacobian(count, count);
  constexpr double kShift = 1e-6;
  for (Eigen::Index j = 0; j < count; ++j) {
    states[j] = kShift;
    effect.state_rates(brisk, base, states, shifted);
    states[j] = 0.0;
    for (Eigen::Index i = 0; i < count; ++i) jacobian(i, j) = (shifted[i] - rates[i]) / kShift;
  }
  return jacobian.eigenvalues().cwiseAbs().maxCoeff();
}

}  // namespace

double fastest_rate(const models::ArmParameters& arm, const std::vector<models::EffectPtr>& effects,
                    double stylus_mass_kg) {
  double rate = std::max(arm.b1_Ns_per_m / stylus_mass_kg, std::sqrt(arm.k1_N_per_m / stylus_mass_kg));
  for (const auto& effect : effects) {
    if (effect->acts_on_signal()) continue;
    const Place place = effect->place();
    const PortBase base = place == Place::grasp ? PortBase{arm.k1_N_per_m, arm.b1_Ns_per_m, 0.0}
                          : place == Place::arm ? PortBase{arm.k2_N_per_m, arm.b2_Ns_per_m, arm.mass_kg}
                                                : PortBase{};
    const double mass = place == Place::joint ? stylus_mass_kg
                        : place == Place::arm ? arm.mass_kg
                                              : std::min(arm.mass_kg, stylus_mass_kg);
    const std::vector<double> states(effect->state_count(), 0.0);
    rate = std::max({rate, steepest(*effect, base, states, true) / mass,
                     std::sqrt(steepest(*effect, base, states, false) / mass), own_rate(*effect, base)});
  }
  return rate;
}

}  // namespace handloop::sim
