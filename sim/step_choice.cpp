#include "sim/step_choice.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "models/errors.h"
#include "sim/actuator_effects.h"

namespace handloop::sim {
namespace {

using models::Effect;
using models::Place;
using models::PortBase;
using models::PortMotion;

/// At which the effects' own states are looked at.
constexpr double kBriskSpeed_m_per_s = 0.2;
/// Explicit fourth-order steps follow rates up to this over the step to a fraction of a percent.
constexpr double kRateTimesStep = 0.7;
constexpr int kMostSubsteps = 200;
/// Apparent mass of the bare device at its tip, at least (set A and B, any axis).
constexpr double kLeastTipMass_kg = 0.028;

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

/// Fastest rate (1/s) on one axis that an explicit step has to follow, where the arm holds a stylus of the given mass.
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

void require_positive(const char* key, double value) {
  if (!(value > 0) || !std::isfinite(value)) {
    throw InputError(std::string(key) + " = " + std::to_string(value) + " is not possible: it must be above zero");
  }
}

}  // namespace

int choose_substeps(const models::Scenario& scenario) {
  const double sample = scenario.loop.sample_time_s;
  require_positive("loop.sample_time_s", sample);
  require_positive("run.physics_step_s", scenario.run.physics_step_s);
  double rate = 2 * std::numbers::pi * scenario.device.structural_frequency_Hz;
  for (const models::Axis axis : models::kAxes) {
    const auto index = static_cast<std::size_t>(axis);
    models::AxisModel held;
    held.arm = scenario.arm.axes[index];
    if (const auto& rigid = scenario.arm.rigid[index]) {
      held.base = models::BaseModel::msd;
      held.msd = *rigid;
    }
    double stylus = kLeastTipMass_kg + scenario.device.stylus_mass_kg;
    models::ArmParameters grasp{.mass_kg = stylus};  // nothing held, or a hand that is one with the stylus
    if (scenario.arm.attached) {
      models::require_valid(held);
      if (held.base == models::BaseModel::arm5) {
        grasp = held.arm;
      } else {
        stylus += held.msd.mass_kg;
        grasp = {.mass_kg = stylus, .k1_N_per_m = held.msd.k_N_per_m, .b1_Ns_per_m = held.msd.b_Ns_per_m};
      }
    }
    rate = std::max(rate, fastest_rate(grasp, effects_of(scenario, axis), stylus));
  }
  const double longest = std::min(scenario.run.physics_step_s, kRateTimesStep / rate);
  return std::clamp(static_cast<int>(std::ceil(sample / longest - 1e-9)), 1, kMostSubsteps);
}

}  // namespace handloop::sim
