#include "identify/explain/force_view.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "identify/explain/signals.h"

namespace handloop::identify {
namespace {

constexpr double kBandwidth_Hz = 15.0;  // acceleration from measured positions is noise above it

/// Coefficients within sign constraints: a column whose coefficient leaves its range is left out. The first three are
/// mass, damper and spring, which cannot be negative.
Eigen::VectorXd admissible_solution(const Eigen::MatrixXd& columns, const Eigen::VectorXd& force,
                                    const std::vector<std::pair<double, double>>& range) {
  std::vector<Eigen::Index> used;
  for (Eigen::Index j = 0; j < columns.cols(); ++j) used.push_back(j);
  Eigen::VectorXd solution = Eigen::VectorXd::Zero(columns.cols());
  while (!used.empty()) {
    Eigen::MatrixXd chosen(columns.rows(), static_cast<Eigen::Index>(used.size()));
    for (std::size_t k = 0; k < used.size(); ++k) chosen.col(static_cast<Eigen::Index>(k)) = columns.col(used[k]);
    const Eigen::VectorXd found = (chosen.transpose() * chosen).ldlt().solve(chosen.transpose() * force);
    solution.setZero();
    std::vector<Eigen::Index> kept;
    for (std::size_t k = 0; k < used.size(); ++k) {
      const auto [lower, upper] = range[static_cast<std::size_t>(used[k])];
      const double value = found[static_cast<Eigen::Index>(k)];
      if (!(value > lower && value < upper)) continue;
      kept.push_back(used[k]);
      solution[used[k]] = value;
    }
    if (kept.size() == used.size()) break;
    used = std::move(kept);
  }
  return solution;
}

}  // namespace

ForceView::ForceView(const Prediction& prediction, const models::AxisModel& model)
    : prediction_(prediction), model_(model), motion_(prediction.recorded_motion(model)) {
  // mass, damper, spring, and every effect found so far as it stands
  known_ = {acceleration(motion_.arm), seen(motion_.arm.v_m_per_s), seen(motion_.arm.x_m)};
  for (const auto& effect : model.effects) {
    if (!effect->acts_on_signal()) known_.push_back(column(*effect));
  }
  force_ = felt_force(model);
}
Eigen::VectorXd ForceView::seen(std::span<const double> signal) const {
  const auto thinned = prediction_.filtered_train(smoothed(signal, kBandwidth_Hz, prediction_.sample_time_s()));
  return Eigen::Map<const Eigen::VectorXd>(thinned.data(), static_cast<Eigen::Index>(thinned.size()));
}

models::ArmParameters ForceView::arm_with(const Eigen::VectorXd& solution) const {
  auto arm = model_.arm;
  arm.mass_kg = std::max(solution[0], 1e-3);
  arm.b2_Ns_per_m = std::max(solution[1], 0.1);
  arm.k2_N_per_m = std::max(solution[2], 1.0);
  return arm;
}

ForceStart ForceView::regress(Variant variant, const std::vector<std::size_t>& gains) const {
  for (const auto gain : used_gains(variant)) variant.values[gain] = 0.0;
  const auto& parameters = variant.type->info.parameters;
  std::vector<std::pair<double, double>> range(known_.size(), {0.0, HUGE_VAL});
  for (const auto g : gains) range.emplace_back(parameters[g].lower, parameters[g].upper);
  Eigen::MatrixXd columns(force_.size(), static_cast<Eigen::Index>(known_.size() + gains.size()));
  Eigen::Index next = 0;
  for (const auto& one : known_) columns.col(next++) = one;
  for (const auto gain : gains) {
    const auto [effect, size] = unit_effect(variant, gains, gain);
    columns.col(next++) = column(*effect) / size;
  }
  Eigen::VectorXd felt = force_;
  if (gains.empty()) {
    auto through = model_;
    through.effects.push_back(models::make_effect(variant.type->info.name, variant.place, variant.values));
    felt = felt_force(through);
  }
  const Eigen::VectorXd solution = admissible_solution(columns, felt, range);
  const auto found = solution.tail(static_cast<Eigen::Index>(gains.size()));
  ForceStart start{variant, model_.arm};
  if (!(solution[0] > 0) || (!gains.empty() && found.isZero())) return start;
  start.left = (felt - columns * solution).squaredNorm() / felt.squaredNorm();
  for (std::size_t g = 0; g < gains.size(); ++g) start.variant.values[gains[g]] = found[static_cast<Eigen::Index>(g)];
  start.arm = arm_with(solution);
  return start;
}

Eigen::VectorXd ForceView::felt_force(const models::AxisModel& through) const {
  const auto recorded = std::span(prediction_.recording().force_N).first(prediction_.train_samples());
  return seen(force_without_signal_effects(through, recorded, prediction_.sample_time_s()));
}

Eigen::VectorXd ForceView::acceleration(const PlaceMotion& at) const {
  const double h = prediction_.sample_time_s();
  return seen(derivative(smoothed(at.v_m_per_s, kBandwidth_Hz, h), h));
}

Eigen::VectorXd ForceView::column(const models::Effect& effect) const {
  const auto& at = motion_.at(effect.place());
  Eigen::VectorXd force = seen(force_along(model_, effect, motion_, prediction_.options(true)));
  if (const double mass = effect.added_mass_kg(0.0); mass > 0) force += mass * acceleration(at);
  return force;
}

}  // namespace handloop::identify
