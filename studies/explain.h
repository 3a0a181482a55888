#pragma once

#include <filesystem>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <optional>

#include "control/margins.h"
#include "identify/explain/explain.h"

/// `handloop explain`: a recording in, the augmented model, the report and the machine form out.
namespace handloop::studies {

struct ExplainStudy {
  models::Recording recording;
  std::optional<models::Recording> validation;
  identify::ExplainOptions options;
};

/// Margins of the default wall loop with the plant as first fitted and as augmented. Judged where a device's tip
/// inertia is known: for rotary recordings there is no wall, and both are empty.
struct MarginsBeforeAfter {
  std::optional<control::Margins> before, after;
  double critical_stiffness_before = 0.0, critical_stiffness_after = 0.0;  ///< N/m, same damping
};

struct ExplainOutcome {
  identify::Explanation explanation;
  MarginsBeforeAfter margins;
  double seconds = 0.0;
};

ExplainOutcome run_explain(const ExplainStudy& study);

/// CONTRACT.md's explain.json.
nlohmann::ordered_json explain_json(const ExplainStudy& study, const ExplainOutcome& outcome);
/// DIR/model.toml, explain.json and report.html, whole or not at all.
void write_explanation(const std::filesystem::path& directory, const ExplainStudy& study,
                       const ExplainOutcome& outcome);

}  // namespace handloop::studies
