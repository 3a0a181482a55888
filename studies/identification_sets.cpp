#include <algorithm>
#include <cmath>
#include <set>

#include "studies/identification.h"

namespace handloop::studies {

namespace {

using identify::FrequencyResponse;

/// Responses at other frequencies than most (a record of another length) cannot be averaged with them and stay out.
std::vector<FrequencyResponse> comparable(const std::vector<const FrequencyResponse*>& responses) {
  const FrequencyResponse* usual = nullptr;
  std::size_t most = 0;
  for (const auto* candidate : responses) {
    const auto same =
        static_cast<std::size_t>(std::count_if(responses.begin(), responses.end(), [&](const auto* other) {
          return other->frequency_Hz == candidate->frequency_Hz;
        }));
    if (same > most) {
      most = same;
      usual = candidate;
    }
  }
  std::vector<FrequencyResponse> out;
  for (const auto* r : responses) {
    if (r->frequency_Hz == usual->frequency_Hz) out.push_back(*r);
  }
  return out;
}

std::array<models::ParameterStatistics, 5> describe_arms(const std::vector<models::ArmParameters>& arms,
                                                         models::PercentileReading reading) {
  std::array<models::ParameterStatistics, 5> out{};
  std::vector<double> values(arms.size());
  for (std::size_t p = 0; p < 5; ++p) {
    for (std::size_t i = 0; i < arms.size(); ++i) values[i] = models::to_array(arms[i])[p];
    out[p] = identify::describe(values, reading);
  }
  return out;
}

/// Subjects that were recorded once at every grip force, at least two of each.
std::optional<std::array<identify::RepeatedMeasures, 5>> grip_effect(const std::vector<IdentifiedTrial>& trials,
                                                                     const AxisSet& set, IdentificationMethod method) {
  std::map<int, std::map<int, std::size_t>> by_subject;
  std::set<int> grips;
  for (const auto i : set.trials) {
    const auto& t = trials[i].trial;
    if (t.subject == 0 || t.grip == 0) return std::nullopt;
    if (!by_subject[t.subject].emplace(t.grip, i).second) return std::nullopt;
    grips.insert(t.grip);
  }
  std::erase_if(by_subject, [&](const auto& entry) { return entry.second.size() != grips.size(); });
  if (by_subject.size() < 2 || grips.size() < 2) return std::nullopt;
  std::array<identify::RepeatedMeasures, 5> out;
  for (std::size_t p = 0; p < 5; ++p) {
    Eigen::MatrixXd values(static_cast<Eigen::Index>(by_subject.size()), static_cast<Eigen::Index>(grips.size()));
    Eigen::Index row = 0;
    for (const auto& [subject, recorded] : by_subject) {
      Eigen::Index column = 0;
      for (const auto& [grip, i] : recorded) values(row, column++) = models::to_array(trials[i].by(method).fit.arm)[p];
      ++row;
    }
    out[p] = identify::repeated_measures(values);
  }
  return out;
}

FittedEnvelope envelope_of(const std::vector<double>& frequency_Hz, const std::vector<double>& dB,
                           const std::optional<models::Axis>& axis, models::UncertaintySet set) {
  FittedEnvelope out;
  out.fitted = identify::fit_envelope(frequency_Hz, dB);
  if (axis) {
    const auto& table = models::uncertainty(*axis, set);
    out.published = identify::compare_envelope(table, frequency_Hz, dB);
    out.published_lifted = identify::lifted_envelope(table, frequency_Hz, dB);
  }
  return out;
}

void add_models(AxisSet& set, const std::vector<IdentifiedTrial>& trials, IdentificationMethod method, bool complete) {
  std::map<int, std::vector<const FrequencyResponse*>> by_grip;
  std::vector<const FrequencyResponse*> all;
  for (const auto i : set.trials) {
    all.push_back(&trials[i].by(method).response);
    if (trials[i].trial.grip > 0) by_grip[trials[i].trial.grip].push_back(all.back());
  }
  for (const auto& [grip, responses] : by_grip) {
    set.grip_response[grip] = identify::mean_response(comparable(responses));
    set.by_grip[grip] = identify::fit_arm(set.grip_response[grip]);
  }
  const auto responses = comparable(all);
  if (responses.size() < 2) return;
  identify::ArmFitSettings unweighted;
  unweighted.weight = identify::FitWeight::none;
  set.nominal = identify::fit_arm(identify::central_response(responses), unweighted);
  set.variability = identify::unstructured_variability(responses, set.nominal->arm);
  if (!complete) return;
  const auto& v = *set.variability;
  set.maximum = envelope_of(v.frequency_Hz, v.maximum_dB, set.axis, models::UncertaintySet::maximum);
  set.percentile67 = envelope_of(v.frequency_Hz, v.percentile67_dB, set.axis, models::UncertaintySet::percentile67);
  set.grip_effect = grip_effect(trials, set, method);
}

}  // namespace

std::vector<AxisSet> identify_sets(const std::vector<IdentifiedTrial>& trials, IdentificationMethod method,
                                   models::PercentileReading percentiles, bool complete) {
  std::map<int, AxisSet> by_axis;  // -1: no axis given
  for (std::size_t i = 0; i < trials.size(); ++i) {
    const auto& axis = trials[i].trial.axis;
    auto& set = by_axis[axis ? static_cast<int>(*axis) : -1];
    set.axis = axis;
    set.trials.push_back(i);
  }
  std::vector<AxisSet> out;
  for (auto& [key, set] : by_axis) {
    std::vector<models::ArmParameters> found, truth;
    std::vector<double> rmse;
    for (const auto i : set.trials) {
      found.push_back(trials[i].by(method).fit.arm);
      rmse.push_back(trials[i].by(method).rmse_m);
      if (trials[i].trial.truth) truth.push_back(*trials[i].trial.truth);
    }
    set.statistics = describe_arms(found, percentiles);
    set.rmse_m = identify::describe(rmse, percentiles);
    if (truth.size() == found.size()) {
      set.truth = describe_arms(truth, percentiles);
      for (std::size_t p = 0; p < 5; ++p) set.bias[p] = set.statistics[p].mean / (*set.truth)[p].mean - 1;
    }
    add_models(set, trials, method, complete);
    out.push_back(std::move(set));
  }
  return out;
}

}  // namespace handloop::studies
