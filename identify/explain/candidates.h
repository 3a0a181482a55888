#pragma once

#include <array>
#include <functional>
#include <optional>
#include <vector>

#include "identify/explain/fit.h"

namespace handloop::identify {

/// Starts of the five-parameter arm: Table II of Fu and Cavusoglu, and Diaz's arm of Table V for a stiff grasp.
inline constexpr std::array<models::ArmParameters, 4> kUsualArms{{{0.2179, 379.5, 78.75, 1.839, 4.645},
                                                                  {0.2692, 552.4, 105.3, 3.609, 6.430},
                                                                  {0.2041, 769.9, 271.7, 0.7764, 18.06},
                                                                  {0.22, 3662, 98.6, 1.18, 6.88}}};

/// An effect of the catalogue at one place, with every choice made: what a search tries.
struct Variant {
  const models::EffectType* type = nullptr;
  models::Place place = models::Place::arm;
  std::vector<double> values;  ///< in the order of the info's parameters; choices as chosen
};

/// Spread of the motion at a place, in which search ranges are measured.
struct MotionScale {
  double x = 1e-3, v = 1e-2;  ///< standard deviations, m and m/s
};
MotionScale scale_at(const Trajectory& motion, models::Place place);

/// Calls `visit` with the variant's values for every combination of shape starts.
void for_each_start(const Variant& variant, const MotionScale& scale,
                    const std::function<void(std::vector<double>)>& visit);
/// Indices of the parameters that the variant's force is proportional to.
std::vector<std::size_t> used_gains(const Variant& variant);
/// The variant with one of its gains at 1, or the nearest that is admissible, and the others at zero.
struct UnitEffect {
  models::EffectPtr effect;
  double size = 1.0;  ///< of that gain
};
UnitEffect unit_effect(Variant variant, const std::vector<std::size_t>& gains, std::size_t gain);

/// A model with the parameters that belong to it and how well it predicts.
struct Hypothesis {
  models::AxisModel model;
  std::vector<FreeParameter> free;
  double train_cost = 0.0;        ///< mean square of the filtered training error
  Hold hold = Hold::first_order;  ///< what the force does between samples, as this model sees it
  Errors errors;

  /// Fits the training part better, or as well with fewer parameters.
  bool better_than(const Hypothesis& other) const;
  std::string effect_names() const;  ///< "reflex_feedback + cubic_stiffness", "" for the base model
};

/// A variant with good values to start a fit from, and how much of the training error's power a first-order step
/// towards it would take away (score test: the residual projected on what the effect would do, the parts that the
/// model's own parameters can do taken out).
struct ScanResult {
  Variant variant;
  double share = 0.0;
  double statistic = 0.0;  ///< the same as a number of standard deviations, from the scatter between seconds
  std::size_t starts = 0;  ///< how many were tried to find it
};

/// All variants that make sense for this base model and input, those whose effects the model already has left out.
std::vector<Variant> search_variants(const models::AxisModel& model, DrivenBy driven_by);

/// Scores every variant without refitting; best first.
std::vector<ScanResult> scan(const Prediction& prediction, const Hypothesis& from,
                             const std::vector<Variant>& variants);

/// Adds the variant to the hypothesis and fits everything together. Nothing where no finite fit was found.
std::optional<Hypothesis> extend(const Prediction& prediction, const Hypothesis& from, const Variant& variant,
                                 const FitOptions& options = {});
/// The same from one given arm and the variant's values as they are; a gain that starts at zero stays there.
std::optional<Hypothesis> extend_from(const Prediction& prediction, const Hypothesis& from, const Variant& variant,
                                      const models::ArmParameters& arm, const FitOptions& options = {});

/// The prediction problem with the hold of a hypothesis. Every function below sees to that itself.
Prediction with_hold(const Prediction& prediction, Hold hold);

/// The better of the hypothesis as it is and refitted with the other hold: a model that misses an effect may choose
/// wrongly.
Hypothesis reconsider_hold(const Prediction& prediction, Hypothesis hypothesis);

/// Fits the hypothesis' own parameters again and judges it.
std::optional<Hypothesis> refit(const Prediction& prediction, const Hypothesis& from, const FitOptions& options = {});

/// Other choices of its last effect (order, direction, exponent, ...), one at a time from where it stands: a scan may
/// have chosen wrongly where the base model was bent.
Hypothesis reconsider_choices(const Prediction& prediction, Hypothesis hypothesis);

/// Takes out gains the data does not ask for: of an effect with several, each one that can be left at zero while the
/// training error's power grows by less than 1 %.
Hypothesis pruned(const Prediction& prediction, const Hypothesis& from);

/// Without its effect number `effect`, refitted.
std::optional<Hypothesis> without(const Prediction& prediction, const Hypothesis& from, std::size_t effect);

}  // namespace handloop::identify
