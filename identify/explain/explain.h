#pragma once

#include "identify/explain/noise_floor.h"
#include "identify/explain/rest.h"
#include "identify/explain/search.h"

/// From a recording to the effect its model lacks: base fit, noise floor, fingerprints, competing candidates judged on
/// held-out data, and the rest that no catalogued effect explains.
namespace handloop::identify {

struct ExplainOptions {
  models::BaseModel base = models::BaseModel::arm5;
  models::Axis axis = models::Axis::x;
  DrivenBy driven_by = DrivenBy::force;
  SearchOptions search;
};

enum class Verdict { effect_added, no_effect, unexplained_residual };
std::string_view verdict_name(Verdict verdict);

/// What an effect would leave in the residual of the base model, and whether it is there.
struct Fingerprint {
  std::string name;  ///< of the effect
  std::string meaning;
  double statistic = 0.0;  ///< standard deviations
  double p_value = 1.0;    ///< corrected for all starts and effects tried
  double share = 0.0;      ///< of the residual's power
  bool significant = false;
};

struct FoundEffect {
  std::string name;
  models::Place place = models::Place::arm;
  std::vector<std::string> keys;  ///< of its parameters
  std::vector<double> values;
  std::vector<double> half_width95;  ///< 0 where a parameter was not fitted
  double rmse_validation_without = 0.0;
};

struct Rival {
  std::string name;  ///< the effects that stand where the chosen ones do
  double rmse_validation = 0.0;
  double filtered_validation = 0.0;
  bool indistinguishable = false;
  std::string separate_by;
};

struct Explanation {
  Verdict verdict = Verdict::no_effect;
  bool sign_reversed = false;  ///< the recorded force opposed the motion it was said to drive
  Hypothesis base, after;
  Errors catalogue;  ///< with the named effects only, before any tabulated rest
  NoiseFloor floor;
  std::vector<Fingerprint> fingerprints;
  std::vector<FoundEffect> effects;
  std::vector<double> base_half_width95;  ///< of after's base parameters
  std::vector<Rival> rivals;
  std::optional<Rest> rest;        ///< only where it is believed
  double share_of_residual = 0.0;  ///< power of the error that the rest took away
  SpectralLine line;
  std::size_t variants_tried = 0;
  models::AxisOperatingPoint point;                     ///< how far things moved in this recording
  std::vector<double> residual_before, residual_after;  ///< over the whole fitting record, output's unit
};

/// Throws InputError where the recording cannot be explained at all (no finite base model).
Explanation explain(const models::Recording& recording, const std::optional<models::Recording>& validation,
                    const ExplainOptions& options);

}  // namespace handloop::identify
