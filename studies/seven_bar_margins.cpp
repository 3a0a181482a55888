#include "studies/seven_bar_margins.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "control/controllers/force_amplifier.h"
#include "models/seven_bar.h"
#include "studies/margins_json.h"

namespace handloop::studies {
namespace {

using Json = nlohmann::ordered_json;

Json to_json(const std::optional<control::Limit>& limit) {
  if (!limit) return nullptr;
  return {{"alpha", limit->factor}, {"frequency_rad_per_s", limit->frequency_rad_per_s}};
}

std::string text_of(const control::TransferMargins& result) {
  const auto& m = result.margins;
  if (!m.stable) return fmt::format("UNSTABLE: a pole at {:.4g} 1/s", result.abscissa);
  return fmt::format("stable: gain x {:.4g}, phase {:.4g} deg, delay {:.4g} s, |1+L| {:.4g}, disk {:.4g}", m.gain_up,
                     m.phase_deg, m.delay_s, m.modulus, m.disk_alpha);
}

double printed_limit() {
  double low = 5, high = 19;
  for (int i = 0; i < 50; ++i) {
    const double middle = 0.5 * (low + high);
    (control::evaluate(seven_bar_loop(middle)).margins.stable ? low : high) = middle;
  }
  return low;
}

}  // namespace

const char* const kSevenBarAssumption =
    "the paper gives no filter K, no gains of its position controller and no dimensions: K = k/(0.03 s + 1)^3 with k = "
    "0.0198 m/N is ours, chosen so that alpha = 5 and 8 are stable and 19 is not, as in its experiment; so are the "
    "lengths and masses of the links";

control::TransferLoop seven_bar_loop(double alpha, double filter_gain) {
  control::ForceControl c;
  c.K = {{filter_gain}, {2.7e-5, 2.7e-3, 0.09, 1}};
  c.alpha = control::diagonal_matrix({{alpha}, {1}}, {{alpha}, {1}});
  c.environment_kg *= models::kPrintedEnvironmentMass_kg;
  return control::axis_loop(c, 0);
}

SevenBarMargins seven_bar_margins(const models::Scenario& scenario) {
  SevenBarMargins result;
  for (const double alpha : {8.0, 5.0, 19.0}) {
    result.printed.push_back({alpha, control::evaluate(seven_bar_loop(alpha))});
  }
  result.alpha_limit = printed_limit();
  const auto& f = scenario.force_amplifier;
  const Eigen::Vector2d th(scenario.device.pose_rad[0], scenario.device.pose_rad[1]);
  const auto loop = control::force_control_of(scenario, th);
  const control::ModelledPrimary primary(scenario, th);
  const control::Sensitivity none;
  const bool diagonal = loop.alpha.diagonal() && loop.environment_kg(0, 1) == 0.0;
  for (std::size_t i = 0; i < 2; ++i) {
    auto& axis = result.axes[i];
    axis.environment_kg = loop.environment_kg(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(i));
    if (!diagonal) continue;
    axis.loop = control::evaluate(control::axis_loop(loop, i));
    axis.ideal = control::axis_limit(loop, none, i);
    axis.modelled = control::axis_limit(loop, primary, i);
  }
  result.together = control::amplification_limit(loop, primary);
  result.small_gain = control::small_gain(loop);
  result.stable = std::isfinite(result.small_gain.gain_m_per_N) && (!result.together || result.together->factor > 1.0);
  result.band_rad_per_s = f.performance_band_rad_per_s;
  result.epsilon = f.performance_tolerance;
  result.performance = control::performance(loop, primary, result.band_rad_per_s, result.epsilon);
  result.nonlinear_gain_N_per_m =
      control::cubic_gain_N_per_m(loop, f.hand_cubic_N_per_m3, scenario.safety.workspace_radius_m);
  return result;
}

Json to_json(const SevenBarMargins& r) {
  Json j;
  j["scenario"] = "seven_bar";
  j["assumption"] = kSevenBarAssumption;
  j["stable"] = r.stable;
  j["nominal"] = r.axes[1].loop ? to_json(*r.axes[1].loop) : Json(nullptr);
  j["alpha_limit"] = r.alpha_limit;
  for (const auto& [alpha, result] : r.printed) {
    auto entry = to_json(result);
    entry["alpha"] = alpha;
    j["loops"].push_back(entry);
  }
  for (std::size_t i = 0; i < 2; ++i) {
    const auto& axis = r.axes[i];
    j["axes"].push_back({{"axis", i == 0 ? "x" : "y"},
                         {"environment_kg", axis.environment_kg},
                         {"margins", axis.loop ? to_json(*axis.loop) : Json(nullptr)},
                         {"limit_without_sensitivities", to_json(axis.ideal)},
                         {"limit", to_json(axis.modelled)}});
  }
  j["alpha_factor_limit"] = to_json(r.together);
  j["performance"] = {{"band_rad_per_s", r.band_rad_per_s},       {"epsilon", r.epsilon},
                      {"worst_error", r.performance.worst_error}, {"at_rad_per_s", r.performance.worst_at_rad_per_s},
                      {"inequality_8", r.performance.met_8},      {"inequality_9", r.performance.met_9}};
  const bool bounded = std::isfinite(r.small_gain.gain_m_per_N);
  j["small_gain"] = {{"lambda_Gc_m_per_N", bounded ? Json(r.small_gain.gain_m_per_N) : Json("inf")},
                     {"error_bound_m_per_N", r.small_gain.error_bound},
                     {"permitted_lambda_Delta_N_per_m", bounded ? r.small_gain.permitted_N_per_m : 0.0},
                     {"lambda_Delta_N_per_m", r.nonlinear_gain_N_per_m},
                     {"inequality_15", bounded && r.nonlinear_gain_N_per_m < r.small_gain.permitted_N_per_m}};
  return j;
}

std::string to_text(const SevenBarMargins& r) {
  std::string text = fmt::format("seven_bar: loop G K (alpha H0 + E0) of Kazerooni and Her; {}\n", kSevenBarAssumption);
  text += "As printed (E0 = 9.08 s^2, S_h = S_e = 0):\n";
  for (const auto& [alpha, result] : r.printed) text += fmt::format("  alpha = {:<4g} {}\n", alpha, text_of(result));
  text += fmt::format("  stable up to alpha = {:.5g}\n", r.alpha_limit);
  text += fmt::format("This scenario: {}\n", r.stable ? "stable" : "UNSTABLE");
  for (std::size_t i = 0; i < 2; ++i) {
    const auto& axis = r.axes[i];
    text += fmt::format("  {}: E = {:.4g} s^2 N/m; {}\n", i == 0 ? "x" : "y", axis.environment_kg,
                        axis.loop ? text_of(*axis.loop) : "alpha couples the axes");
    if (axis.ideal && axis.modelled) {
      text += fmt::format("     alpha may be {:.4g} with S_h = S_e = 0, {:.4g} with those of the position controller\n",
                          axis.ideal->factor, axis.modelled->factor);
    }
  }
  if (r.together) text += fmt::format("  the whole of alpha may grow by {:.4g}\n", r.together->factor);
  text += fmt::format("  performance over 0 to {:g} rad/s: (8) {:.3g} at {:.3g} rad/s, {} epsilon = {:g}; (9) {}\n",
                      r.band_rad_per_s, r.performance.worst_error, r.performance.worst_at_rad_per_s,
                      r.performance.met_8 ? "below" : "NOT BELOW", r.epsilon,
                      r.performance.met_9 ? "holds" : "DOES NOT HOLD");
  text += fmt::format(
      "  small gain (15): A-norm of G_c {:.7g} m/N, so a nonlinear Delta may have a gain up to {:.5g} "
      "N/m; this one's is at most {:.4g}\n",
      r.small_gain.gain_m_per_N, r.small_gain.permitted_N_per_m, r.nonlinear_gain_N_per_m);
  return text;
}

}  // namespace handloop::studies
