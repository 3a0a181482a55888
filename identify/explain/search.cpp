#include "identify/explain/search.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <limits>
#include <set>

#include "identify/arm_fit.h"
#include "identify/explain/force_scan.h"
#include "identify/explain/signals.h"
#include "identify/spectra.h"
#include "models/errors.h"

namespace handloop::identify {
namespace {

using models::AxisModel;
using models::BaseModel;

/// Times the filtered noise, above which one effect that helps little is no reason to give up.
constexpr double kFarFromNoise = 5.0;
/// Of a candidate that is tried though the scan saw nothing of it.
constexpr double kSmallestShare = 1e-9;
/// Share of the error of every other candidate, below which one at the edge of its range is kept.
constexpr double kAloneAtEdge = 0.5;
constexpr FitOptions kFirstFit{.most_iterations = 25, .tolerance = 1e-5};

/// Mass, damping and stiffness by regression of the force on the smoothed motion, constant term aside.
models::MsdParameters regress_msd(const models::Recording& recording, double bandwidth_Hz) {
  const double h = recording.sample_time_s;
  const auto x = smoothed(recording.position_m, bandwidth_Hz, h);
  const auto v = derivative(x, h), a = derivative(v, h);
  const auto f = smoothed(recording.force_N, bandwidth_Hz, h);
  Eigen::MatrixXd columns(x.size(), 4);
  for (std::size_t i = 0; i < x.size(); ++i) columns.row(static_cast<Eigen::Index>(i)) << a[i], v[i], x[i], 1.0;
  const Eigen::VectorXd solution = columns.colPivHouseholderQr().solve(
      Eigen::Map<const Eigen::VectorXd>(f.data(), static_cast<Eigen::Index>(f.size())));
  return {solution[0], solution[1], solution[2]};
}

/// Arms that the recording's frequency response asks for. Unlike a simulation error it has no valley at "no motion at
/// all", in which a fit ends whose resonance begins far from the true one.
std::vector<models::ArmParameters> arms_from_response(const models::Recording& recording) {
  try {
    ArmFitSettings settings;
    settings.sample_time_s = recording.sample_time_s;
    const auto spectra = welch(recording.force_N, recording.position_m, recording.sample_time_s,
                               long_segment_settings(recording.size(), recording.sample_time_s));
    return arm_candidates(frequency_response(spectra), settings, 3);
  } catch (const InputError&) {
    return {};  // too short a record for a spectrum
  }
}

void report(const SearchOptions& options, double share, const std::string& what) {
  if (options.progress) options.progress(share, what);
}

/// Variants worth a refit: each effect at its best place and choice, by score. The least gain that would be accepted
/// asks for twice its share of the error's power. A refit can find more than the first step promises, at the first
/// depth above all, where the base model has bent itself towards the missing effect: there the best few are always
/// tried.
std::vector<ScanResult> shortlist(const std::vector<ScanResult>& ranked, const std::vector<ForceStart>& force_starts,
                                  const SearchOptions& options, int depth) {
  const std::size_t count = depth == 1 ? options.refits_first : options.refits_next, always = depth == 1 ? 3 : 0;
  std::vector<ScanResult> list;
  std::set<std::string_view> names;
  for (const auto& result : ranked) {
    if (list.size() == count) break;
    if (list.size() >= always && result.share < std::max(options.rule.gain, 0.15 * ranked.front().share)) break;
    if (names.insert(result.variant.type->info.name).second) list.push_back(result);
  }
  // what has no gain starts from usual arms, whatever the bent base model lets the scan see of it
  if (depth == 1) {
    for (const auto& result : ranked) {
      const auto& info = result.variant.type->info;
      const bool gainless =
          std::ranges::none_of(info.parameters, [](const auto& p) { return p.search.role == models::Role::gain; });
      if (gainless && names.insert(info.name).second) list.push_back({result.variant, kSmallestShare});
    }
  }
  // What the force side can start is tried too: behind a bent base model all of it, later the two it thinks most of.
  const std::size_t more = depth == 1 ? force_starts.size() : 2;
  for (std::size_t i = 0; i < std::min(more, force_starts.size()); ++i) {
    const auto& variant = force_starts[i].variant;
    if (names.insert(variant.type->info.name).second) list.push_back({variant, 0.0});
  }
  return list;
}

/// A signal late by less than a sample is the hold of the force, not an effect. A delay, time constant, frequency or
/// mass that ends at the edge of its range is not that effect: it stands in for another.
bool stands_in(const Hypothesis& hypothesis, double sample_time_s) {
  const auto values = get_values(hypothesis.model, hypothesis.free);
  for (std::size_t i = 0; i < hypothesis.free.size(); ++i) {
    const auto& p = hypothesis.free[i];
    if (p.effect < 0) continue;
    const auto& search = hypothesis.model.effects[p.effect]->info().parameters[p.index].search;
    const bool telling =
        search.role == models::Role::shape && search.scale == models::Scale::absolute && !search.edge_allowed;
    const double value = values[static_cast<Eigen::Index>(i)];
    if (hypothesis.model.effects[p.effect]->acts_on_signal() && telling && value < sample_time_s) return true;
    if (telling && (value <= 1.01 * p.lower || value >= 0.99 * p.upper)) return true;
  }
  return false;
}

/// One at the edge stays where nothing else comes near it: the effect is right, that value of it unsure.
void drop_those_that_stand_in(std::vector<Hypothesis>& hypotheses, double sample_time_s) {
  double others = std::numeric_limits<double>::infinity();
  for (const auto& one : hypotheses) {
    if (!stands_in(one, sample_time_s)) others = std::min(others, one.errors.filtered_validation);
  }
  std::erase_if(hypotheses, [&](const auto& one) {
    const bool alone =
        !one.model.effects.back()->acts_on_signal() && one.errors.filtered_validation < kAloneAtEdge * others;
    return stands_in(one, sample_time_s) && !alone;
  });
}

/// The candidate's fit from where the scan and from where the force side would start it, not to the last digit.
std::optional<Hypothesis> first_fit(const Prediction& prediction, const Hypothesis& from, const ScanResult& candidate,
                                    const std::vector<ForceStart>& force_starts) {
  auto fitted = candidate.share > 0 ? extend(prediction, from, candidate.variant, kFirstFit) : std::nullopt;
  const auto same_effect = [&](const ForceStart& s) { return s.variant.type == candidate.variant.type; };
  if (const auto start = std::ranges::find_if(force_starts, same_effect); start != force_starts.end()) {
    auto other = extend_from(prediction, from, start->variant, start->arm, kFirstFit);
    if (other && (!fitted || other->train_cost < fitted->train_cost)) fitted = std::move(other);
  }
  return fitted;
}

Tried as_tried(const Hypothesis& hypothesis, std::size_t depth, double share) {
  Tried tried{depth, {}, share, hypothesis};
  for (const auto& effect : hypothesis.model.effects) tried.names.emplace_back(effect->info().name);
  std::ranges::sort(tried.names);
  return tried;
}

/// The base model bends its grasp towards a missing effect and so misleads the force side; the best first effect has
/// a truer one. What the force side starts from there, where it is better.
void look_again(const Prediction& prediction, const Hypothesis& seed, std::vector<Hypothesis>& extended,
                SearchResult& result) {
  Hypothesis from = seed;
  from.model.arm = extended.front().model.arm;
  const auto variants = search_variants(from.model, prediction.driven_by());
  const auto held = with_hold(prediction, extended.front().hold);
  auto starts = force_scan(held, from, variants);
  starts.resize(std::min<std::size_t>(starts.size(), 3), ForceStart{});
  for (auto& start : single_gain_scan(held, from, variants)) starts.push_back(std::move(start));
  for (const auto& start : starts) {
    auto fitted = extend_from(prediction, seed, start.variant, start.arm, {.most_iterations = 5, .tolerance = 1e-3});
    if (!fitted || fitted->train_cost > 4 * extended.front().train_cost) continue;
    fitted = refit(prediction, *fitted, kFirstFit);
    if (!fitted) continue;
    const auto name = fitted->effect_names();
    for (auto& known : extended) {
      if (known.effect_names() == name && fitted->better_than(known)) known = *fitted;
    }
    for (auto& tried : result.tried) {
      if (tried.hypothesis.effect_names() == name && fitted->better_than(tried.hypothesis)) tried.hypothesis = *fitted;
    }
  }
}

Hypothesis converged(const Prediction& prediction, Hypothesis hypothesis) {
  hypothesis = reconsider_hold(prediction, reconsider_choices(prediction, std::move(hypothesis)));
  auto fitted = refit(prediction, pruned(prediction, hypothesis), {.most_iterations = 40, .tolerance = 1e-7});
  return fitted ? std::move(*fitted) : hypothesis;
}

/// Nothing left to find: no effect could gain what the rule asks for.
bool at_noise(const Hypothesis& hypothesis, const SearchOptions& options) {
  return hypothesis.errors.filtered_validation * (1 - options.rule.gain) < options.filtered_noise;
}

std::vector<double> logarithms(std::vector<double> powers) {
  for (double& power : powers) power = std::log(std::max(power, 1e-300));
  return powers;
}

}  // namespace

bool improves(const Errors& first, const Errors& second, const AcceptanceRule& rule, std::size_t tried) {
  if (!(second.filtered_validation < (1 - rule.gain) * first.filtered_validation)) return false;
  const auto blocks = std::min(first.blocks_validation.size(), second.blocks_validation.size());
  if (blocks < 4) return false;
  const boost::math::students_t distribution(static_cast<double>(blocks - 1));
  // Two losses, so each at half the significance. The mean square sees an error that is small but everywhere. An effect
  // that speaks in a few loud blocks, such as a spring that hardens, has so uneven a gain in power that its mean is
  // never proven; its gain in decibels is even.
  const double critical = boost::math::quantile(boost::math::complement(
      distribution, rule.significance / (2.0 * static_cast<double>(std::max<std::size_t>(1, tried)))));
  const auto &before = first.blocks_validation, &after = second.blocks_validation;
  return std::max(diebold_mariano(before, after), diebold_mariano(logarithms(before), logarithms(after))) > critical;
}

Hypothesis fit_base(Prediction& prediction, BaseModel base, models::Axis axis) {
  std::vector<AxisModel> starts;
  AxisModel model;
  model.base = base;
  model.axis = axis;
  model.rotary = prediction.recording().rotary;
  if (base == BaseModel::arm5) {
    for (const auto& arm : kUsualArms) {
      model.arm = arm;
      starts.push_back(model);
    }
    for (const auto& arm : arms_from_response(prediction.recording())) {
      model.arm = arm;
      starts.push_back(model);
    }
  } else {
    for (const double bandwidth : {15.0, 40.0}) {
      const auto raw = regress_msd(prediction.recording(), bandwidth);
      model.msd = {std::max(raw.mass_kg, 1e-9), std::max(raw.b_Ns_per_m, 0.0), std::max(raw.k_N_per_m, 0.0)};
      if (raw.mass_kg <= 0) model.msd.mass_kg = 1e-3 * (std::abs(raw.b_Ns_per_m) + std::abs(raw.k_N_per_m) + 1e-6);
      starts.push_back(model);
    }
  }
  std::optional<Fit> best;
  const auto free = base_parameters(starts.front());
  for (const auto& start : starts) {
    auto tried = fit(prediction, start, base_parameters(start), {.most_iterations = 40});
    if (tried.ok && (!best || tried.cost < best->cost)) best = std::move(tried);
  }
  if (!best)
    throw InputError(prediction.recording().name + ": no " + (base == BaseModel::arm5 ? "arm5" : "msd") +
                     " model follows this recording");
  if (prediction.driven_by() == DrivenBy::force) {
    // Does the record's force hold still between samples, or run on? The fitting part decides.
    prediction.set_hold(Hold::zero_order);
    const auto held = fit(prediction, best->model, best->free, {.most_iterations = 40});
    if (held.ok && held.cost < best->cost)
      best = held;
    else
      prediction.set_hold(Hold::first_order);
  }
  Hypothesis hypothesis{best->model, best->free, best->cost, prediction.hold(), prediction.errors(best->model)};
  if (!hypothesis.errors.finite)
    throw InputError(prediction.recording().name + ": the base model diverges on the held-out part");
  return hypothesis;
}

SearchResult search_effects(const Prediction& prediction, const Hypothesis& base,
                            const std::vector<ScanResult>& base_ranked, const SearchOptions& options) {
  SearchResult result{base, base, {}, 0};
  Hypothesis seed = base;
  if (prediction.driven_by() == DrivenBy::position) {
    // A force is read with a zero of its own. It goes along from the start, for other effects would bend themselves to
    // stand in for it, and has to prove itself at the end.
    const Variant offset{&models::find_effect_type("offset"), models::Place::actuator, {0.0, 0.0}};
    if (auto with_offset = extend(prediction, base, offset)) seed = std::move(*with_offset);
  }
  result.best = seed;
  std::vector<Hypothesis> beam{seed};
  const std::size_t free_ride = seed.model.effects.size();
  for (int depth = 1; depth <= options.max_effects && !at_noise(result.best, options); ++depth) {
    std::vector<Hypothesis> extended;
    std::set<std::vector<std::string>> seen;
    double done = 0;
    for (const auto& from : beam) {
      const auto variants = search_variants(from.model, prediction.driven_by());
      const bool known = from.model.effects.empty();
      const auto ranked = known ? base_ranked : scan(prediction, from, variants);
      if (depth == 1) result.variants_scanned = variants.size();
      const auto force_starts = force_scan(with_hold(prediction, from.hold), from, variants);
      const auto list = shortlist(ranked, force_starts, options, depth);
      for (const auto& candidate : list) {
        report(options, (depth - 1 + done / static_cast<double>(beam.size() * list.size())) / options.max_effects,
               from.effect_names() + (from.model.effects.empty() ? "" : " + ") +
                   std::string(candidate.variant.type->info.name));
        ++done;
        auto fitted = first_fit(prediction, from, candidate, force_starts);
        if (!fitted) continue;
        result.tried.push_back(as_tried(*fitted, free_ride + static_cast<std::size_t>(depth), candidate.share));
        if (seen.insert(result.tried.back().names).second) extended.push_back(std::move(*fitted));
      }
    }
    const auto error = [](const Hypothesis& hypothesis) { return hypothesis.errors.filtered_validation; };
    drop_those_that_stand_in(extended, prediction.sample_time_s());
    if (extended.empty()) break;
    std::ranges::sort(extended, {}, error);
    if (depth == 1 && !at_noise(extended.front(), options)) {
      look_again(prediction, seed, extended, result);
      std::ranges::sort(extended, {}, error);
    }
    // behind a bent base model the hold may be chosen wrongly for many, later for few
    const std::size_t reconsidered = depth == 1 ? 6 : 2;
    for (std::size_t i = 0; i < std::min(reconsidered, extended.size()); ++i) {
      const Hold before = extended[i].hold;
      extended[i] = reconsider_hold(prediction, std::move(extended[i]));
      if (extended[i].hold == before) continue;
      for (auto& tried : result.tried) {
        if (tried.hypothesis.effect_names() == extended[i].effect_names()) tried.hypothesis = extended[i];
      }
    }
    std::ranges::sort(extended, {}, error);
    // convergence moves a fit by far less than what the rule asks for
    if (depth > 1 && error(extended.front()) > error(result.best)) break;
    // of equals the simplest: within 3 % of the best, the one with fewest parameters goes first
    const double equal = 1.03 * error(extended.front());
    auto simplest = extended.begin();
    for (auto at = extended.begin(); at != extended.end() && error(*at) < equal; ++at) {
      if (at->free.size() < simplest->free.size()) simplest = at;
    }
    std::rotate(extended.begin(), simplest, simplest + 1);
    // the few best to convergence: an unfinished fit leaves a rest that invites a false next effect
    extended.resize(std::min(options.beam, extended.size()));
    for (auto& hypothesis : extended) hypothesis = converged(prediction, std::move(hypothesis));
    for (std::size_t i = 1; i < extended.size(); ++i) {
      if (error(extended[i]) < 0.97 * error(extended.front())) std::swap(extended.front(), extended[i]);
    }
    if (improves(result.best.errors, extended.front().errors, options.rule, result.variants_scanned)) {
      result.best = extended.front();
    } else if (depth > 1 || error(result.best) < kFarFromNoise * options.filtered_noise) {
      break;  // far from the noise two effects may hide each other: then the second is looked for all the same
    }
    beam = std::move(extended);
  }
  // backward: an effect stays only while its absence would be noticed
  for (std::size_t i = 0; i < result.best.model.effects.size();) {
    auto reduced =
        result.best.model.effects.size() == 1 ? std::optional(result.base) : without(prediction, result.best, i);
    if (reduced && !improves(reduced->errors, result.best.errors, options.rule,
                             result.best.model.effects.size() == 1 ? result.variants_scanned : 1)) {
      result.best = std::move(*reduced);
      i = 0;
    } else {
      ++i;
    }
  }
  return result;
}

}  // namespace handloop::identify
