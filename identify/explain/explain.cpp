#include "identify/explain/explain.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <boost/math/distributions/normal.hpp>
#include <cmath>
#include <complex>
#include <numbers>
#include <set>

#include "identify/explain/signals.h"

namespace handloop::identify {
namespace {

using models::Place;

/// What the tabulated rest must gain to be called structure: more than an effect, for it has a hundred knots.
constexpr AcceptanceRule kRestRule{.gain = 0.10, .significance = 0.01};

/// Times the error of two named effects, below which one law without a name does as well.
constexpr double kAsGood = 1.05;

/// True where the force as recorded would need a negative mass or spring.
bool force_is_reversed(const models::Recording& recording) {
  const double h = recording.sample_time_s;
  const auto x = smoothed(recording.position_m, 15.0, h), f = smoothed(recording.force_N, 15.0, h);
  const auto v = derivative(x, h), a = derivative(v, h);
  // whatever a plant stores it gives back, what it dissipates it does not: the mean power tells the sign
  const double power = correlation(f, v);
  if (std::abs(power) > 0.1) return power < 0;
  Eigen::MatrixXd columns(x.size(), 4);
  for (std::size_t i = 0; i < x.size(); ++i) columns.row(static_cast<Eigen::Index>(i)) << a[i], v[i], x[i], 1.0;
  const Eigen::VectorXd c = columns.colPivHouseholderQr().solve(
      Eigen::Map<const Eigen::VectorXd>(f.data(), static_cast<Eigen::Index>(f.size())));
  // power that each term explains, with the sign it would need
  double vote = 0;
  for (Eigen::Index j = 0; j < 3; ++j) {
    const double size =
        c[j] * standard_deviation(std::vector<double>(columns.col(j).data(), columns.col(j).data() + columns.rows()));
    vote += std::copysign(size * size, size);
  }
  return vote < 0;
}

std::vector<Fingerprint> take_fingerprints(const std::vector<ScanResult>& ranked) {
  std::size_t starts = 0;
  for (const auto& result : ranked) starts += result.starts;
  std::vector<Fingerprint> prints;
  std::set<std::string_view> seen;
  for (const auto& result : ranked) {
    const auto& info = result.variant.type->info;
    if (!seen.insert(info.name).second) continue;
    const double single =
        2 * boost::math::cdf(boost::math::complement(boost::math::normal(), std::abs(result.statistic)));
    const double corrected = std::min(1.0, single * static_cast<double>(starts));
    prints.push_back({std::string(info.name), std::string(info.fingerprint), result.statistic, corrected, result.share,
                      corrected < 0.01});
  }
  return prints;
}

std::vector<double> residual_over_all(const Prediction& prediction, const models::AxisModel& model) {
  const auto run = prediction.run(model, false, true);
  const auto& measured = prediction.measured();
  std::vector<double> residual(measured.size());
  for (std::size_t i = 0; i < residual.size(); ++i) residual[i] = measured[i] - run.output[i];
  return residual;
}

models::OperatingPoint point_of(const PlaceMotion& motion, double duration_s) {
  return {std::max(standard_deviation(motion.x_m), 1e-9), std::max(standard_deviation(motion.v_m_per_s), 1e-9),
          mean(motion.x_m), duration_s};
}

/// Constant position error that is more than wander: its mean over blocks of three seconds stands four deviations clear
/// and taking it away helps the held-out part.
std::optional<double> constant_error(const Prediction& prediction, const models::AxisModel& model, double gain) {
  const auto residual = residual_over_all(prediction, model);
  const auto train = std::span(residual).first(prediction.train_samples());
  const auto means = decimated(train, static_cast<std::size_t>(std::max(1.0, 3.0 / prediction.sample_time_s())));
  if (means.size() < 6) return std::nullopt;
  const double centre = mean(means);
  const double deviation =
      standard_deviation(means) * std::sqrt(2.0 / static_cast<double>(means.size() - 1));  // neighbours agree
  if (std::abs(centre) < 4 * deviation) return std::nullopt;
  auto held_out = prediction.validation_error(model);
  const double before = rms(held_out);
  for (double& value : held_out) value -= centre;
  if (rms(held_out) > (1 - gain) * before) return std::nullopt;
  return centre;
}

/// How far a force on the arm's mass moves the grip, m/N, while the grip force is given: all compliance but the
/// grasp's.
double arm_response(const models::AxisModel& model, const models::AxisOperatingPoint& point, double frequency_Hz) {
  const std::complex<double> s(0, 2 * std::numbers::pi * frequency_Hz);
  const auto whole = models::compliance(model, point, s);
  if (model.base != models::BaseModel::arm5) return std::abs(whole);
  return std::abs(whole - 1.0 / (model.arm.k1_N_per_m + model.arm.b1_Ns_per_m * s));
}

std::string names_beyond(const Hypothesis& hypothesis, const Hypothesis& shared) {
  std::set<std::string_view> known;
  for (const auto& effect : shared.model.effects) known.insert(effect->info().name);
  std::string names;
  for (const auto& effect : hypothesis.model.effects) {
    if (!known.contains(effect->info().name)) names.append(names.empty() ? "" : "+").append(effect->info().name);
  }
  return names;
}

std::string how_to_separate(const Hypothesis& hypothesis) {
  return hypothesis.model.effects.empty() ? "" : std::string(hypothesis.model.effects.back()->info().experiment);
}

std::vector<Rival> find_rivals(const SearchResult& search) {
  std::vector<Rival> rivals;
  const auto& best = search.best;
  if (best.model.effects.empty()) return rivals;
  std::set<std::string> seen;
  std::multiset<std::string_view> chosen;
  for (const auto& effect : best.model.effects) chosen.insert(effect->info().name);
  for (const auto& tried : search.tried) {
    if (tried.depth > best.model.effects.size()) continue;
    const std::multiset<std::string_view> names(tried.names.begin(), tried.names.end());
    if (names == chosen) continue;
    const auto name = names_beyond(tried.hypothesis, best);
    if (name.empty()) continue;
    const auto& errors = tried.hypothesis.errors;
    // worse by less than an effect must gain, or by no more than chance: this recording cannot tell
    const bool same = tried.depth == best.model.effects.size() &&
                      !improves(errors, best.errors, {.gain = 0.05, .significance = 0.05}, 1);
    if (!seen.insert(name).second) {
      for (auto& rival : rivals) {
        if (rival.name == name && errors.filtered_validation < rival.filtered_validation) {
          rival = {name, errors.rmse_validation, errors.filtered_validation, same || rival.indistinguishable,
                   rival.separate_by};
        }
      }
      continue;
    }
    rivals.push_back(
        {name, errors.rmse_validation, errors.filtered_validation, same, how_to_separate(tried.hypothesis)});
  }
  std::sort(rivals.begin(), rivals.end(),
            [](const auto& a, const auto& b) { return a.filtered_validation < b.filtered_validation; });
  if (rivals.size() > 6) rivals.resize(6);
  return rivals;
}

/// Bandwidth of the motion filter with the least training error for this model.
void choose_motion_bandwidth(Prediction& prediction, Hypothesis& hypothesis) {
  if (prediction.driven_by() != DrivenBy::position) return;
  std::optional<Hypothesis> best;
  double chosen = prediction.motion_bandwidth_Hz();
  const double nyquist = 0.5 / prediction.sample_time_s();
  for (const double bandwidth : {8.0, 12.0, 18.0, 27.0, 40.0, 60.0, 90.0, 135.0, 200.0}) {
    if (bandwidth > 0.8 * nyquist) break;
    prediction.set_motion_bandwidth(bandwidth);
    auto fitted = refit(prediction, hypothesis, {.most_iterations = 12, .tolerance = 1e-6});
    if (fitted && (!best || fitted->train_cost < best->train_cost)) {
      best = std::move(fitted);
      chosen = bandwidth;
    }
  }
  prediction.set_motion_bandwidth(chosen);
  if (best) hypothesis = std::move(*best);
}

/// A spring or damper that the data does not ask for comes out as nothing.
void drop_idle_base(const Prediction& prediction, Hypothesis& hypothesis) {
  if (hypothesis.model.base != models::BaseModel::msd) return;
  for (const int index : {2, 1}) {
    const auto at = std::find_if(hypothesis.free.begin(), hypothesis.free.end(),
                                 [&](const auto& p) { return p.effect < 0 && p.index == index; });
    if (at == hypothesis.free.end()) continue;
    Hypothesis less = hypothesis;
    Eigen::VectorXd values = get_values(less.model, less.free);
    const auto position = at - hypothesis.free.begin();
    values[position] = 0;
    less.model = with_values(less.model, less.free, values);
    less.free.erase(less.free.begin() + position);
    auto fitted = refit(prediction, less);
    if (fitted && fitted->train_cost < 1.003 * hypothesis.train_cost) hypothesis = std::move(*fitted);
  }
}

/// Bouc-Wen's law that yields within a small part of the motion is dry friction with its presliding: say they are one.
void note_dry_friction(const Prediction& prediction, Explanation& result) {
  for (const auto& effect : result.after.model.effects) {
    if (effect->info().name != "hysteresis") continue;
    const auto motion = prediction.run(result.after.model, true);
    if (effect->parameter("yield_m") > 0.1 * standard_deviation(motion.at(effect->place()).x_m)) continue;
    for (const auto name : {"stribeck_friction", "coulomb_friction"}) {
      std::erase_if(result.rivals, [&](const auto& rival) { return rival.name == name; });
      result.rivals.insert(result.rivals.begin(),
                           {name, result.after.errors.rmse_validation, result.after.errors.filtered_validation, true,
                            "motion smaller than the yield displacement, where friction is a spring"});
    }
  }
}

/// An effect none of whose gains the data tells from zero has not been found, however much its presence helped.
void drop_undetermined(const Prediction& given, Hypothesis& hypothesis) {
  for (std::size_t e = 0; e < hypothesis.model.effects.size();) {
    const auto widths = half_widths95(with_hold(given, hypothesis.hold), hypothesis.model, hypothesis.free);
    const auto values = get_values(hypothesis.model, hypothesis.free);
    const auto& parameters = hypothesis.model.effects[e]->info().parameters;
    bool has_gain = false, determined = false;
    for (std::size_t i = 0; i < hypothesis.free.size(); ++i) {
      const auto& p = hypothesis.free[i];
      if (p.effect != static_cast<int>(e) || parameters[p.index].search.role != models::Role::gain) continue;
      has_gain = true;
      const auto at = static_cast<Eigen::Index>(i);
      determined = determined || std::abs(values[at]) > widths[at];
    }
    auto reduced = has_gain && !determined ? without(given, hypothesis, e) : std::nullopt;
    if (reduced) {
      hypothesis = std::move(*reduced);
    } else {
      ++e;
    }
  }
}

/// Place in the list of a ripple of few periods beside another law of displacement. Such a sum follows any smooth law
/// (free play, a stop, saturation): it is evidence of a law, not of these two.
std::optional<std::size_t> ripple_beside_another_law(const models::AxisModel& model, const Trajectory& motion) {
  constexpr double kTellingPeriods = 4;
  std::optional<std::size_t> ripple;
  bool other = false;
  for (std::size_t i = 0; i < model.effects.size(); ++i) {
    const auto& effect = *model.effects[i];
    const auto name = effect.info().name;
    other = other || name == "cubic_stiffness" || name == "asymmetric_stiffness";
    if (name != "position_ripple") continue;
    const double range = 4 * standard_deviation(motion.at(effect.place()).x_m);
    if (range < kTellingPeriods * effect.parameter("period_m")) ripple = i;
  }
  return other ? ripple : std::nullopt;
}

/// Another law of force moves the mean of the motion: a constant read at the sensor follows it.
void centre_again(const Prediction& prediction, Hypothesis& hypothesis) {
  for (auto& effect : hypothesis.model.effects) {
    if (effect->info().name != "offset" || effect->place() != Place::sensor) continue;
    const auto residual = residual_over_all(prediction, hypothesis.model);
    const std::array values{
        0.0, effect->parameter("position_m") + mean(std::span(residual).first(prediction.train_samples()))};
    effect = models::make_effect("offset", Place::sensor, values);
    hypothesis.errors = prediction.errors(hypothesis.model);
    return;
  }
}

FoundEffect found(const models::Effect& effect) {
  FoundEffect entry{std::string(effect.info().name), effect.place(), {}, {}, {}, 0.0};
  for (std::size_t i = 0; i < effect.parameters().size(); ++i) {
    entry.keys.emplace_back(effect.info().parameters[i].name);
    entry.values.push_back(effect.parameters()[i]);
    entry.half_width95.push_back(0.0);
  }
  return entry;
}

}  // namespace

std::string_view verdict_name(Verdict verdict) {
  return std::array{"effect_added", "no_effect", "unexplained_residual"}[static_cast<std::size_t>(verdict)];
}

Explanation explain(const models::Recording& given, const std::optional<models::Recording>& given_validation,
                    const ExplainOptions& options) {
  Explanation result;
  auto recording = given;
  auto validation = given_validation;
  result.sign_reversed = force_is_reversed(recording);
  if (result.sign_reversed) {
    for (double& value : recording.force_N) value = -value;
    if (validation) {
      for (double& value : validation->force_N) value = -value;
    }
  }
  Prediction prediction =
      validation ? Prediction(recording, *validation, options.driven_by) : Prediction(recording, options.driven_by);
  const auto progress = [&](double share, const std::string& what) {
    if (options.search.progress) options.search.progress(share, what);
  };
  progress(0.0, "base model");
  auto base = fit_base(prediction, options.base, options.axis);
  base.model.rotary = recording.rotary;
  choose_motion_bandwidth(prediction, base);
  result.floor = estimate_noise_floor(prediction, base.model);
  progress(0.05, "fingerprints");
  const auto variants = search_variants(base.model, prediction.driven_by());
  const auto ranked = scan(prediction, base, variants);
  result.variants_tried = variants.size();
  result.fingerprints = take_fingerprints(ranked);

  auto search_options = options.search;
  // where forces are predicted, what the model lacks reaches the bands that tell of noise
  if (prediction.driven_by() == DrivenBy::force) search_options.filtered_noise = filtered_noise(prediction, base.model);
  search_options.progress = [&](double share, const std::string& what) { progress(0.1 + 0.75 * share, what); };
  auto search = search_effects(prediction, base, ranked, search_options);
  choose_motion_bandwidth(prediction, search.best);
  drop_undetermined(prediction, search.best);
  drop_idle_base(prediction, search.best);
  if (auto again = refit(prediction, search.base)) search.base = std::move(*again);
  result.base = search.base;
  result.after = search.best;
  result.rivals = find_rivals(search);
  // from here on everything is judged with the hold of what was found; the base model with its own
  result.base.errors = with_hold(prediction, result.base.hold).errors(result.base.model);
  prediction.set_hold(result.after.hold);
  note_dry_friction(prediction, result);

  // a constant, which the selection filter cannot see where positions are predicted
  if (options.driven_by == DrivenBy::force) {
    if (const auto constant = constant_error(prediction, result.after.model, options.search.rule.gain)) {
      const std::array values{0.0, *constant};
      result.after.model.effects.push_back(models::make_effect("offset", Place::sensor, values));
      result.after.errors = prediction.errors(result.after.model);
    }
  }
  const bool constant_added = std::any_of(result.after.model.effects.begin(), result.after.model.effects.end(),
                                          [](const auto& effect) { return effect->info().name == "offset"; });
  if (constant_added && !recording.rotary) {
    // along a line nothing but the posture tells weight from any other constant
    result.rivals.insert(result.rivals.begin(),
                         {"gravity", result.after.errors.rmse_validation, result.after.errors.filtered_validation, true,
                          std::string(models::find_effect_type("gravity").info.experiment)});
  }
  result.catalogue = result.after.errors;

  progress(0.87, "rest without a name");
  auto named = result.after;
  const auto take_rest = [&](const Hypothesis& from, Rest rest) {
    const double before = from.errors.filtered_validation, after = rest.hypothesis.errors.filtered_validation;
    result.share_of_residual = 1 - (after * after) / (before * before);
    named = from;
    result.after = rest.hypothesis;
    result.rest = std::move(rest);
  };
  const auto rest_of = [&](const Hypothesis& from) {
    auto rest = fit_rest(prediction, from);
    if (rest) centre_again(prediction, rest->hypothesis);
    return rest;
  };
  if (auto rest = rest_of(named); rest && improves(named.errors, rest->hypothesis.errors, kRestRule, 1))
    take_rest(named, std::move(*rest));
  const auto motion_of_named = prediction.run(named.model, true);
  if (const auto ripple = ripple_beside_another_law(named.model, motion_of_named)) {
    const auto both = named;
    const double with_it = result.after.errors.filtered_validation;
    const auto reduced = without(prediction, named, *ripple);
    auto rest = reduced ? rest_of(*reduced) : std::nullopt;
    if (rest && rest->hypothesis.errors.filtered_validation < kAsGood * with_it) {
      result.catalogue = reduced->errors;
      take_rest(*reduced, std::move(*rest));
      result.rivals.insert(result.rivals.begin(),
                           {"position_ripple", both.errors.rmse_validation, both.errors.filtered_validation, true,
                            "larger motion, over which a ripple repeats and another law does not"});
    }
  }

  result.residual_before = residual_over_all(prediction, result.base.model);
  result.residual_after = residual_over_all(prediction, result.after.model);
  const auto& input = options.driven_by == DrivenBy::force ? recording.force_N : recording.position_m;

  progress(0.95, "intervals");
  const auto widths = half_widths95(prediction, named.model, named.free);
  result.base_half_width95.assign(options.base == models::BaseModel::arm5 ? 5 : 3, 0.0);
  for (const auto& effect : named.model.effects) result.effects.push_back(found(*effect));
  for (std::size_t i = 0; i < named.free.size(); ++i) {
    const auto& p = named.free[i];
    const double width = widths[static_cast<Eigen::Index>(i)];
    (p.effect < 0 ? result.base_half_width95[p.index] : result.effects[p.effect].half_width95[p.index]) = width;
  }
  for (std::size_t i = 0; i < result.effects.size(); ++i) {
    const auto reduced = result.effects.size() == 1 ? std::optional(result.base) : without(prediction, named, i);
    if (reduced) result.effects[i].rmse_validation_without = reduced->errors.rmse_validation;
  }
  const auto motion = prediction.run(result.after.model, true);
  const double duration = static_cast<double>(recording.size()) * recording.sample_time_s;
  result.point = {point_of(motion.arm, duration),
                  motion.grasp.x_m.empty() ? models::OperatingPoint{} : point_of(motion.grasp, duration),
                  point_of(motion.joint, duration)};
  models::AxisModel plain = result.after.model;
  std::erase_if(plain.effects, [](const auto& effect) { return effect->info().name == "tabulated"; });
  result.line = find_line(result.residual_after, input, recording.sample_time_s, [&](double frequency_Hz) {
    return options.driven_by == DrivenBy::position ? 1.0 : arm_response(plain, result.point, frequency_Hz);
  });
  if (result.line.significant) {
    const std::array values{result.line.force_rms, result.line.frequency_Hz, std::min(result.line.bandwidth_Hz, 10.0),
                            0.0};
    const auto tremor = models::make_effect("tremor", Place::arm, values);
    result.after.model.effects.push_back(tremor);
    result.effects.push_back(found(*tremor));
    result.effects.back().rmse_validation_without = result.after.errors.rmse_validation;
  }
  result.verdict = result.rest              ? Verdict::unexplained_residual
                   : result.effects.empty() ? Verdict::no_effect
                                            : Verdict::effect_added;
  progress(1.0, "done");
  return result;
}

}  // namespace handloop::identify
