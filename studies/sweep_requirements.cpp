#include "studies/sweep_requirements.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

#include "control/population_margins.h"
#include "models/errors.h"
#include "models/suggest.h"

namespace handloop::studies {
namespace {

std::vector<std::string> quantities() {
  std::vector<std::string> names{"p_stable", "p_stable_lo95", "p_stable_hi95", "rho_p95"};
  for (const std::string_view margin : kSweepMargins)
    for (const std::string_view quantile : kSweepQuantiles) names.push_back(fmt::format("{}_{}", margin, quantile));
  return names;
}

double number(std::string_view text, const std::string& expression) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size())
    throw InputError("requirement '" + expression + "': '" + std::string(text) +
                     "' is not a number; wanted is for example p_stable>=0.95 or gm_up_p05>=2@k=800,b=2");
  return value;
}

/// Gains as people type them: 514.29 for 514.2857.
bool same(double a, double b) {
  return std::abs(a - b) <= 1e-3 * std::max(std::abs(a), std::abs(b));
}

bool names(const Requirement& r, const SweepPoint& point) {
  return (!r.stiffness_N_per_m || same(*r.stiffness_N_per_m, point.stiffness_N_per_m)) &&
         (!r.damping_Ns_per_m || same(*r.damping_Ns_per_m, point.damping_Ns_per_m));
}

}  // namespace

Requirement parse_requirement(const std::string& expression) {
  std::string text;
  for (const char c : expression)
    if (c != ' ') text += c;
  Requirement r;
  r.expression = expression;
  if (const std::size_t at = text.find('@'); at != std::string::npos) {
    // the place may stand before or after the comparison: cut it out
    std::size_t end = text.find_first_of("<>", at);
    if (end == std::string::npos) end = text.size();
    std::string_view place = std::string_view(text).substr(at + 1, end - at - 1);
    while (!place.empty()) {
      const std::string_view part = place.substr(0, place.find(','));
      if (part.starts_with("k=")) {
        r.stiffness_N_per_m = number(part.substr(2), expression);
      } else if (part.starts_with("b=")) {
        r.damping_Ns_per_m = number(part.substr(2), expression);
      } else {
        throw InputError("requirement '" + expression + "': wanted after @ is k=..., b=... or both");
      }
      place = part.size() < place.size() ? place.substr(part.size() + 1) : std::string_view();
    }
    if (!r.stiffness_N_per_m && !r.damping_Ns_per_m)
      throw InputError("requirement '" + expression + "': wanted after @ is k=..., b=... or both");
    text.erase(at, end - at);
  }
  const std::size_t sign = text.find_first_of("<>");
  if (sign == std::string::npos)
    throw InputError("requirement '" + expression + "': no comparison in it; wanted is for example p_stable>=0.95");
  const bool equal = sign + 1 < text.size() && text[sign + 1] == '=';
  r.comparison = text[sign] == '>' ? (equal ? Requirement::Comparison::at_least : Requirement::Comparison::above)
                                   : (equal ? Requirement::Comparison::at_most : Requirement::Comparison::below);
  r.quantity = text.substr(0, sign);
  r.limit = number(std::string_view(text).substr(sign + (equal ? 2 : 1)), expression);
  const std::vector<std::string> names = quantities();
  if (std::find(names.begin(), names.end(), r.quantity) == names.end()) {
    const std::vector<std::string_view> known(names.begin(), names.end());
    throw InputError("requirement '" + expression + "': unknown quantity '" + r.quantity + "'" +
                     suggestion(r.quantity, known));
  }
  return r;
}

double quantity_of(const PointStatistics& cell, const std::string& quantity) {
  if (quantity == "p_stable") return cell.p_stable();
  if (quantity == "p_stable_lo95") return control::clopper_pearson(cell.stable, cell.arms).low95;
  if (quantity == "p_stable_hi95") return control::clopper_pearson(cell.stable, cell.arms).high95;
  if (quantity == "rho_p95") return cell.rho_p95;
  for (std::size_t m = 0; m < kSweepMargins.size(); ++m)
    for (std::size_t q = 0; q < kSweepQuantiles.size(); ++q)
      if (quantity == fmt::format("{}_{}", kSweepMargins[m], kSweepQuantiles[q])) return cell.margins[m].at(q);
  throw InputError("unknown quantity '" + quantity + "'");
}

std::string describe_point(const SweepCondition& condition, const SweepPoint& point) {
  std::string text = fmt::format("axis {}, delay {}", models::axis_name(condition.axis), condition.delay_samples);
  if (condition.device > 0) text += fmt::format(", device {}", condition.device);
  return text + fmt::format(", k = {:.6g} N/m, b = {:.6g} Ns/m", point.stiffness_N_per_m, point.damping_Ns_per_m);
}

void require_place(const Requirement& r, const std::vector<SweepPoint>& points) {
  std::string nearest;
  double distance = INFINITY;
  for (const SweepPoint& p : points) {
    if (names(r, p)) return;
    const auto away = [](double wanted, double there) {
      return std::abs(wanted - there) / std::max(1.0, std::abs(wanted));
    };
    const double d = (r.stiffness_N_per_m ? away(*r.stiffness_N_per_m, p.stiffness_N_per_m) : 0) +
                     (r.damping_Ns_per_m ? away(*r.damping_Ns_per_m, p.damping_Ns_per_m) : 0);
    if (d < distance) {
      distance = d;
      nearest = fmt::format("k={:.6g},b={:.6g}", p.stiffness_N_per_m, p.damping_Ns_per_m);
    }
  }
  throw InputError("requirement '" + r.expression + "': the sweep has no point there; the nearest is " + nearest);
}

RequirementOutcome check_requirement(const Requirement& r, const std::vector<SweepCondition>& conditions,
                                     const std::vector<SweepPoint>& points, const std::vector<PointStatistics>& cells) {
  const bool wants_large =
      r.comparison == Requirement::Comparison::at_least || r.comparison == Requirement::Comparison::above;
  const double none = wants_large ? -INFINITY : INFINITY;  // an unstable arm's margin fails either way it is wanted
  require_place(r, points);
  RequirementOutcome outcome{r.expression, true, ""};
  std::size_t failed = 0, asked = 0, worst = points.size();
  double worst_value = 0;
  for (std::size_t p = 0; p < points.size(); ++p) {
    if (!names(r, points[p])) continue;
    ++asked;
    double value = quantity_of(cells[p], r.quantity);
    if (std::isnan(value)) value = none;
    const bool met = r.comparison == Requirement::Comparison::at_least  ? value >= r.limit
                     : r.comparison == Requirement::Comparison::above   ? value > r.limit
                     : r.comparison == Requirement::Comparison::at_most ? value <= r.limit
                                                                        : value < r.limit;
    failed += !met;
    if (worst == points.size() || (wants_large ? value < worst_value : value > worst_value)) {
      worst = p;
      worst_value = value;
    }
  }
  outcome.met = failed == 0;
  const std::string value =
      std::isinf(worst_value) && worst_value == none ? "that of an unstable arm" : fmt::format("{:.6g}", worst_value);
  outcome.detail =
      fmt::format("{} at {} of {} points; worst: {} at {}", failed ? "not met" : "met", failed ? failed : asked, asked,
                  value, describe_point(conditions[points[worst].condition], points[worst]));
  return outcome;
}

}  // namespace handloop::studies
