#include "identify/explain/fit.h"

#include <Eigen/Dense>
#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <limits>

#include "identify/explain/signals.h"

namespace handloop::identify {
namespace {

using models::AxisModel;
using models::BaseModel;

double to_search(const FreeParameter& p, double value) {
  return p.logarithmic ? std::log(std::max(value, p.lower)) : value / p.scale;
}
double from_search(const FreeParameter& p, double value) {
  return std::clamp(p.logarithmic ? std::exp(value) : value * p.scale, p.lower, p.upper);
}
double search_step(const FreeParameter& p, double at) {
  return p.logarithmic ? 1e-3 : 1e-3 * std::max(std::abs(at), 0.1);
}

Eigen::VectorXd from_search(const std::vector<FreeParameter>& free, const double* search) {
  Eigen::VectorXd values(free.size());
  for (std::size_t i = 0; i < free.size(); ++i) values[static_cast<Eigen::Index>(i)] = from_search(free[i], search[i]);
  return values;
}

/// The filtered training error as a function of the search variables, with its Jacobian by forward differences.
class OutputError {
 public:
  OutputError(const Prediction& prediction, const AxisModel& start, const std::vector<FreeParameter>& free)
      : prediction_(prediction), start_(start), free_(free) {}

  /// Empty where the run diverged.
  Eigen::VectorXd operator()(const Eigen::VectorXd& search) const {
    const auto values = prediction_.train_residual(with_values(start_, free_, from_search(free_, search.data())));
    for (const double value : values) {
      if (!std::isfinite(value)) return {};
    }
    return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
  }

  /// False where no finite neighbour was found on either side.
  bool jacobian(const Eigen::VectorXd& search, const Eigen::VectorXd& at, Eigen::MatrixXd& jacobian) const {
    jacobian.resize(at.size(), search.size());
    Eigen::VectorXd moved = search;
    for (Eigen::Index j = 0; j < search.size(); ++j) {
      const auto& p = free_[static_cast<std::size_t>(j)];
      double step = search_step(p, search[j]);
      if (search[j] + step > to_search(p, p.upper)) step = -step;
      moved[j] = search[j] + step;
      auto beside = (*this)(moved);
      if (beside.size() == 0) {
        step = -step;
        moved[j] = search[j] + step;
        beside = (*this)(moved);
        if (beside.size() == 0) return false;
      }
      moved[j] = search[j];
      jacobian.col(j) = (beside - at) / step;
    }
    return true;
  }

 private:
  const Prediction& prediction_;
  const AxisModel& start_;
  const std::vector<FreeParameter>& free_;
};

/// Levenberg and Marquardt's step with the variables that sit at a bound and would leave it held there.
Eigen::VectorXd damped_step(const Eigen::MatrixXd& information, const Eigen::VectorXd& gradient, double damping,
                            const std::vector<bool>& held) {
  Eigen::MatrixXd matrix = information;
  Eigen::VectorXd right = -gradient;
  for (Eigen::Index j = 0; j < matrix.cols(); ++j) {
    if (held[static_cast<std::size_t>(j)] || !(information(j, j) > 0)) {
      matrix.row(j).setZero();
      matrix.col(j).setZero();
      matrix(j, j) = 1;
      right[j] = 0;
    } else {
      matrix(j, j) *= 1 + damping;
    }
  }
  return matrix.ldlt().solve(right);
}

}  // namespace

std::vector<FreeParameter> base_parameters(const AxisModel& model) {
  if (model.base == BaseModel::arm5) {
    // Mass and dampers may come out as next to nothing and must find back from there: no logarithm for them.
    constexpr std::array kUnit{0.2, 500.0, 100.0, 2.0, 10.0};
    std::vector<FreeParameter> free;
    for (int i = 0; i < 5; ++i) {
      const bool spring = i == 1 || i == 2;
      free.push_back({std::string(models::kArmParameterNames[i]), -1, i,
                      i == 0   ? 1e-4
                      : spring ? 1e-2
                               : 1e-3,
                      1e7, spring, kUnit[i]});
    }
    return free;
  }
  const auto& [m, b, k] = model.msd;
  return {{model.rotary ? "inertia_kg_m2" : "mass_kg", -1, 0, 1e-9, 1e9, true, m},
          {model.rotary ? "b_Nms_per_rad" : "b_Ns_per_m", -1, 1, 0.0, 1e9, false, std::max(b, 1e-6)},
          {model.rotary ? "k_Nm_per_rad" : "k_N_per_m", -1, 2, 0.0, 1e9, false, std::max(k, 1e-6)}};
}

Eigen::VectorXd get_values(const AxisModel& model, const std::vector<FreeParameter>& free) {
  Eigen::VectorXd values(free.size());
  const auto arm = models::to_array(model.arm);
  const std::array msd{model.msd.mass_kg, model.msd.b_Ns_per_m, model.msd.k_N_per_m};
  for (std::size_t i = 0; i < free.size(); ++i) {
    const auto& p = free[i];
    values[static_cast<Eigen::Index>(i)] = p.effect >= 0 ? model.effects[p.effect]->parameters()[p.index]
                                           : model.base == BaseModel::arm5 ? arm[p.index]
                                                                           : msd[p.index];
  }
  return values;
}

AxisModel with_values(const AxisModel& model, const std::vector<FreeParameter>& free, const Eigen::VectorXd& values) {
  AxisModel changed = model;
  auto arm = models::to_array(model.arm);
  std::array msd{model.msd.mass_kg, model.msd.b_Ns_per_m, model.msd.k_N_per_m};
  std::vector<std::vector<double>> effects(model.effects.size());
  for (std::size_t i = 0; i < free.size(); ++i) {
    const auto& p = free[i];
    const double value = values[static_cast<Eigen::Index>(i)];
    if (p.effect < 0) {
      (model.base == BaseModel::arm5 ? arm[p.index] : msd[p.index]) = value;
      continue;
    }
    auto& own = effects[p.effect];
    const auto present = model.effects[p.effect]->parameters();
    if (own.empty()) own.assign(present.begin(), present.end());
    own[p.index] = value;
  }
  changed.arm = models::arm_from_array(arm);
  changed.msd = {msd[0], msd[1], msd[2]};
  for (std::size_t e = 0; e < effects.size(); ++e) {
    if (!effects[e].empty()) {
      changed.effects[e] = models::make_effect(model.effects[e]->info().name, model.effects[e]->place(), effects[e]);
    }
  }
  return changed;
}

Fit fit(const Prediction& prediction, const AxisModel& start, const std::vector<FreeParameter>& free,
        const FitOptions& options) {
  Fit result{start, free, std::numeric_limits<double>::infinity(), false, 0};
  const OutputError error(prediction, start, free);
  const auto count = static_cast<Eigen::Index>(free.size());
  Eigen::VectorXd search(count), lower(count), upper(count);
  const auto values = get_values(start, free);
  for (Eigen::Index j = 0; j < count; ++j) {
    const auto& p = free[static_cast<std::size_t>(j)];
    lower[j] = to_search(p, p.lower);
    upper[j] = to_search(p, p.upper);
    search[j] = std::clamp(to_search(p, values[j]), lower[j], upper[j]);
  }
  Eigen::VectorXd at = error(search);
  if (at.size() == 0) return result;
  double cost = at.squaredNorm();
  result.ok = true;
  double damping = 1e-3;
  Eigen::MatrixXd jacobian;
  // After a good step the Jacobian is carried on by Broyden's rank-one update, at no further simulation; it is taken
  // anew before an ending is believed. Only those taken anew count as iterations.
  constexpr int kMostUpdates = 2;
  constexpr double kGoodStep = 0.02;
  for (int updates = -1; count > 0 && cost > 0;) {
    if (updates < 0) {
      if (result.iterations == options.most_iterations || !error.jacobian(search, at, jacobian)) break;
      ++result.iterations;
      updates = 0;
    }
    const Eigen::MatrixXd information = jacobian.transpose() * jacobian;
    const Eigen::VectorXd gradient = jacobian.transpose() * at;
    std::vector<bool> held(free.size());
    for (Eigen::Index j = 0; j < count; ++j) {
      held[static_cast<std::size_t>(j)] =
          (search[j] <= lower[j] && gradient[j] > 0) || (search[j] >= upper[j] && gradient[j] < 0);
    }
    double fallen = 0;
    const bool fresh = updates == 0;
    bool carry_on = false;
    const double damping_before = damping;
    for (int attempt = 0; attempt < (fresh ? 6 : 1); ++attempt) {
      const Eigen::VectorXd next =
          (search + damped_step(information, gradient, damping, held)).cwiseMax(lower).cwiseMin(upper);
      Eigen::VectorXd there = error(next);
      if (there.size() > 0 && there.squaredNorm() < cost) {
        fallen = 1 - there.squaredNorm() / cost;
        carry_on = fallen > kGoodStep && updates < kMostUpdates;
        if (carry_on) {
          const Eigen::VectorXd moved = next - search;
          jacobian += (there - at - jacobian * moved) * moved.transpose() / moved.squaredNorm();
        }
        search = next;
        at = std::move(there);
        cost = at.squaredNorm();
        damping = std::max(damping / 10, 1e-9);
        break;
      }
      damping = std::min(damping * 8, 1e9);
    }
    updates = carry_on ? updates + 1 : -1;
    if (!fresh) {
      if (fallen == 0) damping = damping_before;
      continue;
    }
    if (fallen < options.tolerance) break;
  }
  result.model = with_values(start, free, from_search(free, search.data()));
  result.cost = cost / static_cast<double>(at.size());
  return result;
}

Eigen::MatrixXd sensitivity(const Prediction& prediction, const AxisModel& model,
                            const std::vector<FreeParameter>& free) {
  const auto at = prediction.train_residual(model);
  Eigen::MatrixXd jacobian =
      Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(at.size()), static_cast<Eigen::Index>(free.size()));
  const auto values = get_values(model, free);
  for (Eigen::Index j = 0; j < jacobian.cols(); ++j) {
    const auto& p = free[static_cast<std::size_t>(j)];
    const double search = to_search(p, values[j]);
    double step = search_step(p, search);
    if (search + step > to_search(p, p.upper)) step = -step;
    auto moved = values;
    moved[j] = from_search(p, search + step);
    const auto beside = prediction.train_residual(with_values(model, free, moved));
    if (beside.size() != at.size()) continue;
    for (std::size_t i = 0; i < at.size(); ++i) jacobian(static_cast<Eigen::Index>(i), j) = -(beside[i] - at[i]) / step;
  }
  return jacobian;
}

Eigen::VectorXd half_widths95(const Prediction& prediction, const AxisModel& model,
                              const std::vector<FreeParameter>& free) {
  const Eigen::MatrixXd jacobian = sensitivity(prediction, model, free);
  const auto residual = prediction.train_residual(model);
  const auto count = jacobian.cols();
  const auto block =
      static_cast<Eigen::Index>(std::max(1.0, std::min(1 / prediction.sample_time_s(), prediction.filter().rate_Hz)));
  Eigen::MatrixXd meat = Eigen::MatrixXd::Zero(count, count);
  double blocks = 0;
  for (Eigen::Index from = 0; from + block <= jacobian.rows(); from += block, ++blocks) {
    const Eigen::VectorXd score =
        jacobian.middleRows(from, block).transpose() * Eigen::Map<const Eigen::VectorXd>(residual.data() + from, block);
    meat += score * score.transpose();
  }
  // scaled to unit diagonal before inversion; directions without curvature are not determined
  const Eigen::MatrixXd information = jacobian.transpose() * jacobian;
  const Eigen::VectorXd size = information.diagonal().cwiseSqrt().cwiseMax(1e-300);
  const Eigen::MatrixXd scaled = size.cwiseInverse().asDiagonal() * information * size.cwiseInverse().asDiagonal();
  const Eigen::MatrixXd inverse = Eigen::MatrixXd(scaled.completeOrthogonalDecomposition().pseudoInverse());
  const Eigen::MatrixXd covariance =
      inverse * (size.cwiseInverse().asDiagonal() * meat * size.cwiseInverse().asDiagonal()) * inverse;
  const double freedom = std::max(1.0, blocks - static_cast<double>(count));
  const double factor = boost::math::quantile(boost::math::students_t(freedom), 0.975) * std::sqrt(blocks / freedom);
  Eigen::VectorXd widths(count);
  const auto values = get_values(model, free);
  for (Eigen::Index j = 0; j < count; ++j) {
    const auto& p = free[static_cast<std::size_t>(j)];
    const double width = factor * std::sqrt(std::max(0.0, covariance(j, j))) / size[j];
    widths[j] =
        size[j] <= 1e-299 ? std::numeric_limits<double>::infinity() : width * (p.logarithmic ? values[j] : p.scale);
  }
  return widths;
}

}  // namespace handloop::identify
