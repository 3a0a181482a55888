#include <cmath>
#include <nlohmann/json.hpp>

#include "studies/identification.h"

namespace handloop::studies {

namespace {

using nlohmann::ordered_json;

std::string axis_key(const std::optional<models::Axis>& axis) {
  return axis ? std::string(models::axis_name(*axis)) : "unspecified";
}

ordered_json to_json(const models::ParameterStatistics& s) {
  return {{"minimum", s.minimum},           {"mean", s.mean},
          {"maximum", s.maximum},           {"standard_deviation", s.standard_deviation},
          {"ci95_minimum", s.ci95_minimum}, {"ci95_maximum", s.ci95_maximum},
          {"ci67_minimum", s.ci67_minimum}, {"ci67_maximum", s.ci67_maximum}};
}

ordered_json to_json(const std::array<models::ParameterStatistics, 5>& statistics) {
  ordered_json out;
  for (std::size_t p = 0; p < 5; ++p) out[std::string(models::kArmParameterNames[p])] = to_json(statistics[p]);
  return out;
}

ordered_json to_json(const identify::ArmFit& fit) {
  ordered_json out;
  const auto values = models::to_array(fit.arm);
  for (std::size_t p = 0; p < 5; ++p) {
    const std::string name(models::kArmParameterNames[p]);
    out[name] = values[p];
    out[name + "_lo95"] = fit.low95[p];
    out[name + "_hi95"] = fit.high95[p];
  }
  out["cost"] = fit.cost;
  return out;
}

ordered_json to_json(const identify::Envelope& e, bool with_model) {
  ordered_json out;
  if (with_model) {
    out["gain"] = e.model.gain;
    const auto roots = [](const std::vector<std::complex<double>>& pairs) {
      auto list = ordered_json::array();
      for (const auto& root : pairs) list.push_back({root.real(), root.imag()});
      return list;
    };
    out["order"] = 2 * e.model.poles.size();
    out["pole_pairs_rad_per_s"] = roots(e.model.poles);
    out["zero_pairs_rad_per_s"] = roots(e.model.zeros);
  }
  out["mean_excess_dB"] = e.mean_excess_dB;
  out["largest_excess_dB"] = e.largest_excess_dB;
  out["least_excess_dB"] = e.least_excess_dB;
  return out;
}

ordered_json to_json(const FittedEnvelope& envelope, const std::vector<double>& data_dB) {
  ordered_json out{{"data_dB", data_dB}, {"envelope", to_json(envelope.fitted, true)}};
  if (envelope.published) out["table_IV_as_published"] = to_json(*envelope.published, false);
  if (envelope.published_lifted) out["table_IV_lifted_to_the_data"] = to_json(*envelope.published_lifted, true);
  return out;
}

ordered_json to_json(const identify::RepeatedMeasures& r) {
  ordered_json out{{"subjects", r.subjects},
                   {"F", r.F},
                   {"numerator_freedom", r.numerator_freedom},
                   {"denominator_freedom", r.denominator_freedom},
                   {"p", r.p},
                   {"greenhouse_geisser_epsilon", r.epsilon},
                   {"p_greenhouse_geisser", r.p_greenhouse_geisser}};
  for (const auto& pair : r.pairs) {
    out["holm_sidak"].push_back({{"first", pair.first + 1},
                                 {"second", pair.second + 1},
                                 {"mean_difference", pair.mean_difference},
                                 {"p", pair.p},
                                 {"p_adjusted", pair.p_holm_sidak}});
  }
  return out;
}

ordered_json to_json(const AxisSet& set) {
  ordered_json out{{"trials", set.trials.size()}, {"parameters", to_json(set.statistics)}};
  if (set.truth) {
    out["true_parameters"] = to_json(*set.truth);
    for (std::size_t p = 0; p < 5; ++p) out["mean_bias"][std::string(models::kArmParameterNames[p])] = set.bias[p];
  }
  for (const auto& [grip, fit] : set.by_grip) out["grip_models"][std::to_string(grip)] = to_json(fit);
  if (set.nominal) out["nominal"] = to_json(*set.nominal);
  if (set.maximum) {
    out["uncertainty"]["frequency_Hz"] = set.variability->frequency_Hz;
    out["uncertainty"]["max"] = to_json(*set.maximum, set.variability->maximum_dB);
    out["uncertainty"]["67"] = to_json(*set.percentile67, set.variability->percentile67_dB);
    out["uncertainty"]["95"] = {{"data_dB", set.variability->percentile95_dB}};
  }
  if (set.grip_effect) {
    for (std::size_t p = 0; p < 5; ++p) {
      out["grip_effect"][std::string(models::kArmParameterNames[p])] = to_json((*set.grip_effect)[p]);
    }
  }
  out["position_rmse_m"] = to_json(set.rmse_m);
  return out;
}

ordered_json by_axis(const std::vector<AxisSet>& sets) {
  ordered_json out = ordered_json::object();
  for (const auto& set : sets) out[axis_key(set.axis)] = to_json(set);
  return out;
}

}  // namespace

std::string statistics_json(const Identification& identification) {
  const auto method = identification.method;
  const bool paper = method == IdentificationMethod::paper;
  ordered_json out{{"method", method_name(method)},
                   {"spectra", spectra_name(identification.spectra)},
                   {"percentiles", models::percentile_reading_name(identification.percentiles)},
                   {"trials", identification.trials.size()},
                   {"axes", by_axis(identification.sets)}};
  out["other_method"] = {{"method", paper ? "unbiased" : "paper"}, {"axes", by_axis(identification.other_sets)}};
  out["recordings"] = ordered_json::array();
  for (const auto& trial : identification.trials) {
    const auto& unbiased = trial.by(IdentificationMethod::unbiased);
    ordered_json row{{"trial", trial.trial.trial},
                     {"name", trial.name},
                     {"samples", trial.samples},
                     {"sample_time_s", trial.sample_time_s},
                     {"position_rmse_m", trial.by(method).rmse_m},
                     {"hold", identify::hold_name(unbiased.fit.hold)},
                     {"hold_is_clear", trial.hold_is_clear},
                     {"delay_s", unbiased.fit.delay_s},
                     {"misfit", trial.misfit}};
    row["warnings"] = ordered_json::array();
    for (const auto& w : trial.doubts) row["warnings"].push_back(w);
    for (const auto& w : trial.by(method).fit.warnings) row["warnings"].push_back(w);
    out["recordings"].push_back(std::move(row));
  }
  out["skipped"] = identification.skipped;
  return out.dump(1) + "\n";
}

}  // namespace handloop::studies
