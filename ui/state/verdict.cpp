#include "ui/state/verdict.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace handloop::ui {
namespace {

constexpr double kEnough = 0.95;  ///< share of the arms that a wall is expected to hold

std::string factor(double x) {
  return std::isinf(x) ? std::string("any") : fmt::format("x {:.3g}", x);
}

std::string hertz(double rad_per_s) {
  return std::isnan(rad_per_s) ? std::string() : fmt::format("at {:.3g} Hz", rad_per_s / (2 * std::numbers::pi));
}

/// One decimal, but "100 %" only where it is every one.
std::string percent(double share) {
  const double value = 100 * share;
  return share < 1 && value > 99.9 ? fmt::format("{:.2f}", std::floor(value * 100) / 100)
                                   : fmt::format("{:.1f}", value);
}

}  // namespace

Verdict verdict_of(const studies::NominalTuning& nominal, const std::optional<control::PopulationMargins>& population) {
  Verdict verdict;
  const auto& m = nominal.margins;
  const std::string whose = nominal.with_effects ? "this arm with its effects" : "this arm";
  if (!m.stable) {
    verdict.outlook = Outlook::unstable;
    verdict.word = "UNSTABLE";
    verdict.sentence = fmt::format("with {}: the slowest mode grows by {:.2g} % a sample", whose, 100 * (m.rho - 1));
  } else {
    verdict.word = "STABLE";
    const double harder = m.gain_up;
    verdict.sentence = std::isinf(harder) ? fmt::format("with {}, whatever the gain", whose)
                                          : fmt::format("with {}; {:.3g} times the gains would not be", whose, harder);
  }
  if (!population) return verdict;
  const auto& share = population->stable;
  verdict.sentence += fmt::format(". {} % of {} sampled arms are stable", percent(share.estimate), share.trials);
  if (m.stable) verdict.outlook = share.estimate >= kEnough ? Outlook::stable : Outlook::doubtful;
  return verdict;
}

std::vector<Figure> figures_of(const studies::NominalTuning& nominal,
                               const std::optional<studies::RobustTuning>& robust,
                               const std::optional<control::PopulationMargins>& population) {
  const auto& m = nominal.margins;
  const std::string none = "none", pending = "...";
  std::vector<Figure> figures;
  figures.push_back(
      {"Gain", m.stable ? factor(m.gain_up) : none,
       m.stable ? "more gain until it rings " + hertz(m.gain_up_at_rad_per_s) : "an unstable loop has none",
       m.stable && m.gain_up > 2});
  figures.push_back({"Phase",
                     !m.stable                 ? none
                     : std::isinf(m.phase_deg) ? std::string("any")
                                               : fmt::format("{:.1f}\u00b0", std::abs(m.phase_deg)),
                     m.stable ? "lag until it rings " + hertz(m.phase_at_rad_per_s) : "an unstable loop has none",
                     m.stable && std::abs(m.phase_deg) > 30});
  figures.push_back(
      {"Delay",
       !m.stable               ? none
       : std::isinf(m.delay_s) ? std::string("any")
                               : fmt::format("{:.2f} ms", 1e3 * m.delay_s),
       m.stable ? "more delay until it rings " + hertz(m.delay_at_rad_per_s) : "an unstable loop has none",
       m.stable && m.delay_s > nominal.loop.timing.sample_time_s});
  figures.push_back(
      {"Disk margin", m.stable ? fmt::format("{:.3f}", m.disk_alpha) : none,
       m.stable ? "gain and phase at once, worst " + hertz(m.disk_at_rad_per_s) : "an unstable loop has none",
       m.stable && m.disk_alpha > 0.5});
  const bool has_arm = nominal.loop.plant.arm.has_value();
  if (!has_arm) {
    figures.push_back({"Robust peak", "no arm", "|W_u T| is defined for the five-parameter arm", std::nullopt});
  } else if (!m.stable) {
    figures.push_back({"Robust peak", none, "an unstable loop is not robust", false});
  } else if (!robust || !robust->peak67) {
    figures.push_back({"Robust peak", pending, "being computed", std::nullopt});
  } else {
    figures.push_back({"Robust peak", fmt::format("{:.3g}", robust->peak67->peak),
                       fmt::format("|W_u T| of the 67 % arms at {:.3g} Hz, robust below 1; {:.3g} for all arms",
                                   robust->peak67->frequency_Hz, robust->peak_maximum->peak),
                       robust->peak67->peak < 1});
  }
  if (!has_arm) {
    figures.push_back({"Arms stable", "no arm", "", std::nullopt});
  } else if (!population) {
    figures.push_back({"Arms stable", pending, "being sampled", std::nullopt});
  } else {
    const auto& s = population->stable;
    figures.push_back({"Arms stable", percent(s.estimate) + " %",
                       fmt::format("95 % interval {} to {} %, {} arms{}", percent(s.low95), percent(s.high95), s.trials,
                                   nominal.with_effects ? ", effects left out" : ""),
                       s.estimate >= kEnough});
  }
  if (!robust) {
    figures.push_back({"Stiffest wall", pending, "being computed", std::nullopt});
  } else {
    const double K = robust->critical_stiffness_N_per_m;
    figures.push_back({"Stiffest wall",
                       std::isinf(K) ? std::string("any")
                       : K > 0       ? fmt::format("{:.0f} N/m", K)
                                     : none,
                       "that this damping holds with this arm", std::nullopt});
  }
  return figures;
}

}  // namespace handloop::ui
