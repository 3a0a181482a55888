#include "studies/explain.h"

#include <chrono>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "control/linear_plant.h"
#include "io/json.h"
#include "io/model_file.h"
#include "io/output.h"
#include "models/scenario.h"
#include "studies/explain_report.h"
#include "studies/margins_json.h"

namespace handloop::studies {
namespace {

using Json = nlohmann::ordered_json;
using io::json_number;

constexpr double kTipMass_kg = 0.075;  // the default of `margins --cases`
constexpr double kTipDamping_Ns_per_m = 0.05;

control::Margins margins_of(const models::AxisModel& model, const models::AxisOperatingPoint& point, double stiffness) {
  const models::LoopSettings wall;
  return control::evaluate(
      model, point, kTipMass_kg, kTipDamping_Ns_per_m,
      {.sample_time_s = wall.sample_time_s, .delay_samples = wall.delay_samples, .cutoff_Hz = wall.cutoff_Hz},
      {.stiffness_N_per_m = stiffness, .damping_Ns_per_m = wall.damping_Ns_per_m});
}

/// Largest wall stiffness that is stable, by bisection between nothing and 100 kN/m; infinity where even that is.
double critical_stiffness(const models::AxisModel& model, const models::AxisOperatingPoint& point) {
  double low = 1.0, high = 1e5;
  if (!margins_of(model, point, low).stable) return 0.0;
  if (margins_of(model, point, high).stable) return std::numeric_limits<double>::infinity();
  while (high / low > 1.0005) {
    const double middle = std::sqrt(low * high);
    (margins_of(model, point, middle).stable ? low : high) = middle;
  }
  return std::sqrt(low * high);
}

MarginsBeforeAfter margins_before_after(const identify::Explanation& explanation, bool rotary) {
  MarginsBeforeAfter result;
  if (rotary) return result;
  const models::LoopSettings wall;
  try {
    result.before = margins_of(explanation.base.model, explanation.point, wall.stiffness_N_per_m);
    result.after = margins_of(explanation.after.model, explanation.point, wall.stiffness_N_per_m);
    result.critical_stiffness_before = critical_stiffness(explanation.base.model, explanation.point);
    result.critical_stiffness_after = critical_stiffness(explanation.after.model, explanation.point);
  } catch (const InputError&) {
    result = {};  // a plant that no wall loop can be closed over (no margins to speak of)
  }
  return result;
}

Json base_parameters(const models::AxisModel& model) {
  Json json = Json::object();
  for (const auto& p : identify::base_parameters(model)) {
    json[p.name] = json_number(identify::get_values(model, {p})[0]);
  }
  return json;
}

Json errors(const models::AxisModel& model, const identify::Errors& e) {
  return {{"parameters", base_parameters(model)},
          {"rmse_train", json_number(e.rmse_train)},
          {"rmse_validation", json_number(e.rmse_validation)},
          {"nrmse_validation", json_number(e.nrmse_validation)}};
}

Json margins_json(const std::optional<control::Margins>& margins, double critical_stiffness) {
  if (!margins) return Json::object();
  Json json = to_json(*margins);
  json["critical_stiffness_N_per_m"] = json_number(critical_stiffness);
  return json;
}

Json rest_table(const identify::Rest& rest) {
  const auto& table = *rest.hypothesis.model.effects.back();
  Json json = Json::object();
  for (std::size_t i = 0; i < table.parameters().size(); ++i)
    json[std::string(table.info().parameters[i].name)] = json_number(table.parameters()[i]);
  return json;
}

}  // namespace

ExplainOutcome run_explain(const ExplainStudy& study) {
  const auto start = std::chrono::steady_clock::now();
  ExplainOutcome outcome{identify::explain(study.recording, study.validation, study.options), {}, 0.0};
  outcome.margins = margins_before_after(outcome.explanation, study.recording.rotary);
  outcome.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return outcome;
}

Json explain_json(const ExplainStudy& study, const ExplainOutcome& outcome) {
  const auto& e = outcome.explanation;
  const bool force_driven = study.options.driven_by == identify::DrivenBy::force;
  Json json;
  json["verdict"] = identify::verdict_name(e.verdict);
  json["unit"] = force_driven ? study.recording.position_unit : study.recording.force_unit;
  json["base"] = errors(e.base.model, e.base.errors);
  json["noise_floor"] = {{"rmse", json_number(e.floor.rmse)}, {"how", e.floor.how}};
  json["fingerprints"] = Json::array();
  for (const auto& print : e.fingerprints) {
    json["fingerprints"].push_back({{"name", print.name},
                                    {"statistic", json_number(print.statistic)},
                                    {"p_value", json_number(print.p_value)},
                                    {"significant", print.significant},
                                    {"share_of_residual", json_number(print.share)},
                                    {"meaning", print.meaning}});
  }
  json["effects"] = Json::array();
  for (const auto& effect : e.effects) {
    Json parameters = Json::object(), intervals = Json::object();
    for (std::size_t i = 0; i < effect.keys.size(); ++i) {
      parameters[effect.keys[i]] = json_number(effect.values[i]);
      if (effect.half_width95[i] > 0) {
        intervals[effect.keys[i]] = {json_number(effect.values[i] - effect.half_width95[i]),
                                     json_number(effect.values[i] + effect.half_width95[i])};
      }
    }
    json["effects"].push_back({{"name", effect.name},
                               {"acts_on", models::place_name(effect.place)},
                               {"parameters", parameters},
                               {"interval95", intervals},
                               {"rmse_validation_without", json_number(effect.rmse_validation_without)}});
  }
  json["rivals"] = Json::array();
  for (const auto& rival : e.rivals) {
    json["rivals"].push_back({{"name", rival.name},
                              {"rmse_validation", json_number(rival.rmse_validation)},
                              {"indistinguishable", rival.indistinguishable},
                              {"separate_by", rival.separate_by}});
  }
  json["unexplained"] = {{"description", e.rest ? e.rest->description : ""},
                         {"share_of_residual", json_number(e.share_of_residual)},
                         {"table", e.rest ? rest_table(*e.rest) : Json::object()}};
  json["after"] = errors(e.after.model, e.after.errors);
  json["margins"] = {{"before", margins_json(outcome.margins.before, outcome.margins.critical_stiffness_before)},
                     {"after", margins_json(outcome.margins.after, outcome.margins.critical_stiffness_after)}};
  json["sign_reversed"] = e.sign_reversed;
  json["variants_tried"] = e.variants_tried;
  return json;
}

void write_explanation(const std::filesystem::path& directory, const ExplainStudy& study,
                       const ExplainOutcome& outcome) {
  io::OutputDirectory out(directory);
  io::write_model(out / "model.toml", outcome.explanation.after.model);
  io::write_json(explain_json(study, outcome), (out / "explain.json").string());
  explain_report(study, outcome).write(out / "report.html");
  out.commit();
}

}  // namespace handloop::studies
