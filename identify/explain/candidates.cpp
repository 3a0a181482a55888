#include "identify/explain/candidates.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>

#include "identify/explain/signals.h"

namespace handloop::identify {
namespace {

using models::AxisModel;
using models::EffectParameter;
using models::Place;
using models::Role;
using models::Scale;

double unit_of(const EffectParameter& parameter, const MotionScale& scale) {
  switch (parameter.search.scale) {
    case Scale::position:
      return scale.x;
    case Scale::velocity:
      return scale.v;
    case Scale::absolute:
      break;
  }
  return 1.0;
}

/// Starts of a shape parameter, in its own unit.
std::vector<double> starts(const EffectParameter& parameter, const MotionScale& scale) {
  const auto& search = parameter.search;
  const double unit = unit_of(parameter, scale);
  std::vector<double> values;
  for (int i = 0; i < search.points; ++i) {
    const double share = search.points > 1 ? static_cast<double>(i) / (search.points - 1) : 0.5;
    values.push_back(
        std::clamp(unit * search.from * std::pow(search.to / search.from, share), parameter.lower, parameter.upper));
  }
  return values;
}

/// Values of a parameter that are each a variant of their own; empty where it is no choice.
std::vector<double> choices_of(const EffectParameter& parameter) {
  const auto& search = parameter.search;
  std::vector<double> values;
  if (search.role != Role::choice) return values;
  for (int k = 0; k < search.points; ++k) {
    const double value =
        search.points > 1 ? search.from + (search.to - search.from) * k / (search.points - 1) : search.from;
    values.push_back(std::clamp(value, parameter.lower, parameter.upper));
  }
  return values;
}

/// Free parameters that an effect brings with it; shapes stay within a sane reach of where they are looked for.
std::vector<FreeParameter> effect_parameters(const models::Effect& effect, int number, const MotionScale& scale) {
  std::vector<FreeParameter> free;
  const auto& parameters = effect.info().parameters;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const auto& parameter = parameters[i];
    if (parameter.search.role == Role::choice) continue;
    if (!effect.uses(i)) continue;
    FreeParameter p{
        std::string(parameter.name), number, static_cast<int>(i), parameter.lower, parameter.upper, false, 1.0};
    if (parameter.search.role == Role::shape) {
      const double unit = unit_of(parameter, scale);
      p.lower = std::max(parameter.lower, 0.5 * unit * parameter.search.from);
      p.upper = std::min(parameter.upper, 2.5 * unit * parameter.search.to);
      if (effect.info().name == "position_ripple") p.upper = std::min(parameter.upper, unit * parameter.search.to);
      p.logarithmic = p.lower > 0;
    }
    const double value = effect.parameters()[i];
    p.scale = value != 0 ? std::abs(value) : std::max(std::abs(parameter.typical), 1e-3);
    free.push_back(p);
  }
  return free;
}

AxisModel with_effect(const AxisModel& model, const Variant& variant) {
  AxisModel extended = model;
  extended.effects.push_back(models::make_effect(variant.type->info.name, variant.place, variant.values));
  return extended;
}

/// Adds the variant and its free parameters to a hypothesis.
void add_effect(Hypothesis& hypothesis, const Variant& variant, const MotionScale& scale) {
  hypothesis.model = with_effect(hypothesis.model, variant);
  const int number = static_cast<int>(hypothesis.model.effects.size()) - 1;
  const auto free = effect_parameters(*hypothesis.model.effects.back(), number, scale);
  hypothesis.free.insert(hypothesis.free.end(), free.begin(), free.end());
}

/// What the model's own parameters can take away from a signal: an orthonormal basis of their sensitivities.
class OwnDirections {
 public:
  explicit OwnDirections(const Eigen::MatrixXd& sensitivities) {
    Eigen::MatrixXd scaled = sensitivities;
    for (Eigen::Index j = 0; j < scaled.cols(); ++j) {
      const double size = scaled.col(j).norm();
      if (size > 0) scaled.col(j) /= size;
    }
    const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(scaled);
    const auto rank = qr.rank();
    basis_ = qr.householderQ() * Eigen::MatrixXd::Identity(scaled.rows(), rank);
  }
  Eigen::VectorXd remove(const Eigen::VectorXd& signal) const {
    return signal - basis_ * (basis_.transpose() * signal);
  }

 private:
  Eigen::MatrixXd basis_;
};

Eigen::VectorXd as_vector(const std::vector<double>& values) {
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

/// Least squares in columns of unit norm. Columns that nearly coincide, as those of a spring and a damper that both
/// drift, would come out huge and opposed: there the leading one takes it all.
Eigen::VectorXd leading_coefficients(const Eigen::MatrixXd& columns, const Eigen::VectorXd& signal) {
  constexpr double kSmallestAngle = 0.02;
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr;
  qr.setThreshold(kSmallestAngle);
  qr.compute(columns);
  const auto rank = qr.rank();
  Eigen::VectorXd pivoted = Eigen::VectorXd::Zero(columns.cols());
  pivoted.head(rank) = qr.matrixQR()
                           .topLeftCorner(rank, rank)
                           .triangularView<Eigen::Upper>()
                           .solve((qr.householderQ().transpose() * signal).head(rank).eval());
  return qr.colsPermutation() * pivoted;
}

/// Sum of a score over its scatter between blocks of one second.
double block_statistic(const Eigen::VectorXd& residual, const Eigen::VectorXd& direction, Eigen::Index block) {
  double sum = 0, squares = 0;
  for (Eigen::Index from = 0; from + block <= residual.size(); from += block) {
    const double score = residual.segment(from, block).dot(direction.segment(from, block));
    sum += score;
    squares += score * score;
  }
  return squares > 0 ? sum / std::sqrt(squares) : 0.0;
}

}  // namespace

MotionScale scale_at(const Trajectory& motion, Place place) {
  const auto& at = motion.at(place == Place::sensor || place == Place::actuator ? Place::arm : place);
  return {std::max(standard_deviation(at.x_m), 1e-12), std::max(standard_deviation(at.v_m_per_s), 1e-12)};
}

void for_each_start(const Variant& variant, const MotionScale& scale,
                    const std::function<void(std::vector<double>)>& visit) {
  const auto& parameters = variant.type->info.parameters;
  const auto effect = models::make_effect(variant.type->info.name, variant.place, variant.values);
  std::vector<std::size_t> shapes;
  std::vector<std::vector<double>> values;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    if (parameters[i].search.role != Role::shape || !effect->uses(i)) continue;
    shapes.push_back(i);
    values.push_back(starts(parameters[i], scale));
  }
  std::vector<std::size_t> at(shapes.size(), 0);
  while (true) {
    auto trial = variant.values;
    for (std::size_t k = 0; k < shapes.size(); ++k) trial[shapes[k]] = values[k][at[k]];
    visit(trial);
    std::size_t k = 0;
    while (k < at.size() && ++at[k] == values[k].size()) at[k++] = 0;
    if (k == at.size()) return;
  }
}

std::vector<std::size_t> used_gains(const Variant& variant) {
  const auto effect = models::make_effect(variant.type->info.name, variant.place, variant.values);
  const auto& parameters = variant.type->info.parameters;
  std::vector<std::size_t> gains;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    if (parameters[i].search.role == Role::gain && effect->uses(i)) gains.push_back(i);
  }
  return gains;
}

UnitEffect unit_effect(Variant variant, const std::vector<std::size_t>& gains, std::size_t gain) {
  const auto& parameter = variant.type->info.parameters[gain];
  for (const auto other : gains) variant.values[other] = 0.0;
  const double size = variant.values[gain] = std::clamp(1.0, parameter.lower, parameter.upper);
  return {models::make_effect(variant.type->info.name, variant.place, variant.values), size};
}

bool Hypothesis::better_than(const Hypothesis& other) const {
  const double allowed = free.size() < other.free.size() ? 1.01 : free.size() == other.free.size() ? 1.0 : 0.98;
  return train_cost < allowed * other.train_cost;
}

std::string Hypothesis::effect_names() const {
  std::string names;
  for (const auto& effect : model.effects) names.append(names.empty() ? "" : " + ").append(effect->info().name);
  return names;
}

std::vector<Variant> search_variants(const AxisModel& model, DrivenBy driven_by) {
  std::vector<Variant> variants;
  const bool msd = model.base == models::BaseModel::msd;
  for (const auto& type : models::effect_catalogue()) {
    const auto& info = type.info;
    const bool present = std::any_of(model.effects.begin(), model.effects.end(),
                                     [&](const auto& e) { return e->info().name == info.name; });
    if (present) continue;
    bool arm_done = false;
    for (const Place place : info.search_places) {
      // with mass, spring and damper to ground there is one motion only: grip and arm are the same
      if (msd && place == Place::grasp) continue;
      if (msd && place == Place::joint && arm_done) continue;
      if (!msd && place == Place::arm && info.name == "backlash") continue;  // CONTRACT: of the grasp
      // slow wander hides a constant from a simulated position: offsets are judged apart there, on the plain error
      if (driven_by == DrivenBy::force && info.name == "offset") continue;
      // along a line, gravity is a constant: an offset
      if (info.name == "gravity" && !model.rotary) continue;
      if (info.name == "offset" && place == Place::sensor && !msd) continue;
      arm_done = arm_done || place == Place::arm;
      Variant variant{&type, place, {}};
      std::vector<std::pair<std::size_t, std::vector<double>>> choices;
      for (std::size_t i = 0; i < info.parameters.size(); ++i) {
        variant.values.push_back(info.parameters[i].typical);
        const auto values = choices_of(info.parameters[i]);
        if (values.empty()) continue;
        choices.emplace_back(i, values);
      }
      std::vector<Variant> chosen{variant};
      for (const auto& [index, values] : choices) {
        std::vector<Variant> next;
        for (const auto& one : chosen) {
          for (const double value : values) {
            next.push_back(one);
            next.back().values[index] = value;
          }
        }
        chosen = std::move(next);
      }
      variants.insert(variants.end(), chosen.begin(), chosen.end());
    }
  }
  return variants;
}

std::vector<ScanResult> scan(const Prediction& given, const Hypothesis& from, const std::vector<Variant>& variants) {
  const Prediction prediction = with_hold(given, from.hold);
  const auto motion = prediction.run(from.model, true);
  // A missing effect acts along the true motion, which a poor model does not make: the recorded one is nearer to it,
  // the simulated one free of noise.
  std::vector<Trajectory> motions{motion};
  if (prediction.driven_by() == DrivenBy::force && from.model.effects.empty())
    motions.push_back(prediction.recorded_motion(from.model));
  const Eigen::VectorXd residual = as_vector(prediction.train_residual(from.model));
  const OwnDirections own(sensitivity(prediction, from.model, from.free));
  const Eigen::VectorXd left = own.remove(residual);
  const double power = residual.squaredNorm();
  const auto settings = prediction.options(false);
  const double input_rms = prediction.driven_by() == DrivenBy::force
                               ? standard_deviation(prediction.recording().force_N)
                               : standard_deviation(prediction.measured());
  const auto block =
      static_cast<Eigen::Index>(std::max(1.0, std::min(1 / prediction.sample_time_s(), prediction.filter().rate_Hz)));
  std::vector<ScanResult> results;
  for (const auto& variant : variants) {
    const auto& parameters = variant.type->info.parameters;
    const auto scale = scale_at(motion, variant.place);
    const auto gains = used_gains(variant);
    ScanResult best{variant, -1.0};
    std::size_t starts_tried = 0;
    for_each_start(variant, scale, [&](std::vector<double> trial) {
      ++starts_tried;
      const bool on_signal = variant.place == Place::sensor || variant.place == Place::actuator;
      if (gains.empty() || on_signal) {
        // no gain to scale by: a whole step with the parameters as they are
        if (on_signal && !gains.empty()) {
          trial[gains.front()] = variant.place == Place::actuator ? 0.05 * input_rms : 0.05 * scale.x;
        }
        const auto moved = prediction.train_residual(with_effect(from.model, {variant.type, variant.place, trial}));
        if (moved.size() != static_cast<std::size_t>(residual.size())) return;
        const Eigen::VectorXd direction = own.remove(residual - as_vector(moved));
        const double size = direction.squaredNorm();
        if (!(size > 1e-10 * power)) return;
        const double along = left.dot(direction);
        const bool admissible = along > 0 || !gains.empty();
        const double share = admissible ? along * along / size / power : 0.0;
        if (share > best.share) {
          if (!gains.empty()) {
            trial[gains.front()] *= along / size;
          }
          best = {{variant.type, variant.place, trial}, share, block_statistic(left, along * direction, block)};
        }
        return;
      }
      for (const auto& felt : motions) {
        // forces are proportional to their gains: one response each, gains by least squares
        Eigen::MatrixXd directions(residual.size(), static_cast<Eigen::Index>(gains.size()));
        std::vector<double> reference(gains.size());
        for (std::size_t g = 0; g < gains.size(); ++g) {
          const auto [effect, one] = unit_effect({variant.type, variant.place, trial}, gains, gains[g]);
          reference[g] = one;
          const auto response = first_order_response(from.model, felt, *effect, prediction.driven_by(), settings);
          directions.col(static_cast<Eigen::Index>(g)) = own.remove(as_vector(prediction.filtered_train(response)));
        }
        auto found = trial;
        // solve in unit-norm columns; a column that does nothing gets nothing
        Eigen::VectorXd size(directions.cols());
        for (Eigen::Index g = 0; g < directions.cols(); ++g) {
          size[g] = directions.col(g).norm();
          if (size[g] > 0 && std::isfinite(size[g]))
            directions.col(g) /= size[g];
          else
            directions.col(g).setZero();
        }
        Eigen::VectorXd coefficients = leading_coefficients(directions, left);
        for (Eigen::Index g = 0; g < coefficients.size(); ++g) {
          const auto& parameter = parameters[gains[static_cast<std::size_t>(g)]];
          const double value = size[g] > 0 ? coefficients[g] / size[g] * reference[static_cast<std::size_t>(g)] : 0.0;
          const double possible = std::clamp(value, parameter.lower, parameter.upper);
          if (possible != value) coefficients[g] = 0;  // not admissible: this gain stays at its bound
          found[gains[static_cast<std::size_t>(g)]] = possible;
        }
        const Eigen::VectorXd taken = directions * coefficients;
        const double share = (2 * left.dot(taken) - taken.squaredNorm()) / power;
        if (share > best.share)
          best = {{variant.type, variant.place, found}, share, block_statistic(left, taken, block)};
      }
    });
    best.starts = starts_tried;
    if (best.share >= 0) results.push_back(best);
  }
  std::sort(results.begin(), results.end(), [](const auto& a, const auto& b) { return a.share > b.share; });
  return results;
}

Prediction with_hold(const Prediction& prediction, Hold hold) {
  Prediction other = prediction;
  other.set_hold(hold);
  return other;
}

Hypothesis reconsider_hold(const Prediction& prediction, Hypothesis hypothesis) {
  if (prediction.driven_by() != DrivenBy::force) return hypothesis;
  Hypothesis turned = hypothesis;
  turned.hold = hypothesis.hold == Hold::first_order ? Hold::zero_order : Hold::first_order;
  auto other = refit(prediction, turned, {.most_iterations = 12, .tolerance = 1e-6});
  return other && other->train_cost < hypothesis.train_cost ? std::move(*other) : hypothesis;
}

std::optional<Hypothesis> refit(const Prediction& given, const Hypothesis& from, const FitOptions& options) {
  const Prediction prediction = with_hold(given, from.hold);
  const auto result = fit(prediction, from.model, from.free, options);
  if (!result.ok) return std::nullopt;
  Hypothesis fitted{result.model, from.free, result.cost, from.hold, prediction.errors(result.model)};
  if (!fitted.errors.finite) return std::nullopt;
  return fitted;
}

std::optional<Hypothesis> extend(const Prediction& prediction, const Hypothesis& from, const Variant& variant,
                                 const FitOptions& options) {
  const auto motion = with_hold(prediction, from.hold).run(from.model, true);
  const auto scale = scale_at(motion, variant.place);
  const auto& parameters = variant.type->info.parameters;
  const bool has_gain =
      std::any_of(parameters.begin(), parameters.end(), [](const auto& p) { return p.search.role == Role::gain; });
  const auto with_gains = [&](const models::ArmParameters& arm, double share) {
    auto start = variant;
    for (std::size_t i = 0; i < parameters.size(); ++i) {
      if (parameters[i].search.role == Role::gain)
        start.values[i] = std::clamp(share * start.values[i], parameters[i].lower, parameters[i].upper);
    }
    Hypothesis extended = from;
    extended.model.arm = arm;
    add_effect(extended, start, scale);
    return extended;
  };
  std::optional<Hypothesis> best;
  const auto keep = [&](std::optional<Hypothesis> fitted) {
    if (fitted && (!best || fitted->train_cost < best->train_cost)) best = std::move(fitted);
  };
  // a whole first-order step may overshoot into divergence or into another valley: then from near nothing as well
  for (const double share : {0.7, 0.1}) {
    keep(refit(prediction, with_gains(from.model.arm, share), options));
    if (!has_gain || (best && best->train_cost < 1.0001 * from.train_cost)) break;
  }
  // A grasp that came out rigid leaves everything beyond it no motion to act on.
  constexpr double kRigid = 1e5;
  const bool rigid = from.model.arm.k1_N_per_m > kRigid || from.model.arm.b1_Ns_per_m > kRigid;
  if (from.model.effects.empty() && from.model.base == models::BaseModel::arm5 &&
      (variant.place == Place::grasp || !has_gain || rigid)) {
    // Alone, the base model bends itself towards the missing effect, sometimes too far to find back. At the grasp and
    // on the signals no force scan helps: from a usual arm as well.
    std::optional<Hypothesis> usual;
    for (const auto& arm : kUsualArms) {
      auto begun = refit(prediction, with_gains(arm, 0.7), {.most_iterations = 5, .tolerance = 1e-3});
      if (begun && (!usual || begun->train_cost < usual->train_cost)) usual = std::move(begun);
    }
    if (usual) keep(refit(prediction, *usual, options));
  }
  return best;
}

std::optional<Hypothesis> extend_from(const Prediction& prediction, const Hypothesis& from, const Variant& variant,
                                      const models::ArmParameters& arm, const FitOptions& options) {
  const auto motion = with_hold(prediction, from.hold).run(from.model, true);
  Hypothesis extended = from;
  extended.model.arm = arm;
  add_effect(extended, variant, scale_at(motion, variant.place));
  const int last = static_cast<int>(extended.model.effects.size()) - 1;
  const auto& parameters = variant.type->info.parameters;
  std::erase_if(extended.free, [&](const FreeParameter& p) {
    return p.effect == last && parameters[p.index].search.role == Role::gain && variant.values[p.index] == 0;
  });
  return refit(prediction, extended, options);
}

Hypothesis reconsider_choices(const Prediction& prediction, Hypothesis hypothesis) {
  if (hypothesis.model.effects.empty()) return hypothesis;
  const auto motion = with_hold(prediction, hypothesis.hold).run(hypothesis.model, true);
  const auto& parameters = hypothesis.model.effects.back()->info().parameters;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const auto choices = choices_of(parameters[i]);
    if (choices.size() < 2) continue;
    for (const double choice : choices) {
      const auto effect = hypothesis.model.effects.back();
      if (choice == effect->parameters()[i]) continue;
      Variant variant{&models::find_effect_type(effect->info().name),
                      effect->place(),
                      {effect->parameters().begin(), effect->parameters().end()}};
      variant.values[i] = choice;
      Hypothesis other = hypothesis;
      other.model.effects.pop_back();
      const int last = static_cast<int>(other.model.effects.size());
      std::erase_if(other.free, [&](const auto& p) { return p.effect == last; });
      add_effect(other, variant, scale_at(motion, variant.place));
      auto fitted = refit(prediction, other, {.most_iterations = 4, .tolerance = 1e-3});
      if (!fitted || fitted->train_cost > 1.5 * hypothesis.train_cost) continue;
      fitted = refit(prediction, *fitted, {.most_iterations = 12, .tolerance = 1e-5});
      if (!fitted) continue;
      // a change about some time in or beyond the record may be no more than a steady drift
      if (fitted->better_than(hypothesis)) hypothesis = std::move(*fitted);
    }
  }
  return hypothesis;
}

Hypothesis pruned(const Prediction& prediction, const Hypothesis& from) {
  Hypothesis kept = from;
  for (std::size_t i = 0; i < kept.free.size();) {
    const auto& p = kept.free[i];
    const auto gain = [&](const FreeParameter& q) {
      return q.effect == p.effect && kept.model.effects[q.effect]->info().parameters[q.index].search.role == Role::gain;
    };
    const bool removable = p.effect >= 0 && p.lower <= 0 && gain(p) &&
                           std::count_if(kept.free.begin(), kept.free.end(), gain) > 1 &&
                           kept.model.effects[p.effect]->info().name != "position_ripple";
    if (!removable) {
      ++i;
      continue;
    }
    Eigen::VectorXd values = get_values(kept.model, kept.free);
    values[static_cast<Eigen::Index>(i)] = 0;
    Hypothesis less = kept;
    less.model = with_values(kept.model, kept.free, values);
    less.free.erase(less.free.begin() + static_cast<std::ptrdiff_t>(i));
    const auto fitted =
        fit(with_hold(prediction, less.hold), less.model, less.free, {.most_iterations = 12, .tolerance = 1e-5});
    if (fitted.ok && fitted.cost < 1.01 * kept.train_cost) {
      less.model = fitted.model;
      less.train_cost = fitted.cost;
      kept = std::move(less);
    } else {
      ++i;
    }
  }
  return kept;
}

std::optional<Hypothesis> without(const Prediction& prediction, const Hypothesis& from, std::size_t effect) {
  Hypothesis reduced = from;
  reduced.model.effects.erase(reduced.model.effects.begin() + static_cast<std::ptrdiff_t>(effect));
  reduced.free.clear();
  for (auto p : from.free) {
    if (p.effect == static_cast<int>(effect)) continue;
    if (p.effect > static_cast<int>(effect)) --p.effect;
    reduced.free.push_back(p);
  }
  return refit(prediction, reduced);
}

}  // namespace handloop::identify
