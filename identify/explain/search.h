#pragma once

#include <functional>
#include <string>
#include <vector>

#include "identify/explain/candidates.h"

namespace handloop::identify {

/// When an effect is believed. Chosen before the exams, on other recordings.
struct AcceptanceRule {
  double gain = 0.05;          ///< least relative fall of the filtered held-out error
  double significance = 0.05;  ///< of Diebold and Mariano's test, divided by the number of variants tried
};

struct SearchOptions {
  int max_effects = 3;
  std::size_t beam = 2;           ///< hypotheses carried from one depth to the next
  std::size_t refits_first = 12;  ///< variants refitted at the first depth and at the next ones
  std::size_t refits_next = 7;
  AcceptanceRule rule;
  double filtered_noise = 0.0;  ///< no model's filtered error comes below it; 0 where that is not known
  /// Called with a share of the work done, 0..1, and what is being tried.
  std::function<void(double, const std::string&)> progress;
};

/// A fitted candidate, kept for the report whether it was chosen or not.
struct Tried {
  std::size_t depth = 0;  ///< number of effects in it
  std::vector<std::string> names;
  double share = 0.0;  ///< first-order score of the last effect
  Hypothesis hypothesis;
};

struct SearchResult {
  Hypothesis base;
  Hypothesis best;
  std::vector<Tried> tried;
  std::size_t variants_scanned = 0;
};

/// Best base model of the kind: several starts, hold of the input chosen by the fitting part (force-driven).
/// Throws InputError where no finite fit exists.
Hypothesis fit_base(Prediction& prediction, models::BaseModel base, models::Axis axis);

/// Forward steps with a beam, then backward elimination; every step judged on the held-out part. `ranked` is the scan
/// of the base model's variants.
SearchResult search_effects(const Prediction& prediction, const Hypothesis& base, const std::vector<ScanResult>& ranked,
                            const SearchOptions& options);

/// Does the second explain better than the first by the rule? `tried` is the number of candidates it was chosen from.
bool improves(const Errors& first, const Errors& second, const AcceptanceRule& rule, std::size_t tried);

}  // namespace handloop::identify
