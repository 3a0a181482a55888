#include "identify/explain/prediction.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "identify/explain/signals.h"

namespace handloop::identify {
namespace {

template <class T>
std::span<const T> part(const std::vector<T>& all, std::size_t from, std::size_t count) {
  return std::span<const T>(all).subspan(from, count);
}

std::vector<double> slice(const std::vector<double>& all, std::size_t from, std::size_t count) {
  return {all.begin() + static_cast<std::ptrdiff_t>(from), all.begin() + static_cast<std::ptrdiff_t>(from + count)};
}

}  // namespace

Prediction::Prediction(const models::Recording& recording, DrivenBy driven_by, double held_out)
    : driven_by_(driven_by) {
  fit_.recording = recording;
  train_samples_ = static_cast<std::size_t>(std::llround(static_cast<double>(recording.size()) * (1 - held_out)));
  if (driven_by == DrivenBy::position) filter_.high_pass_Hz = 0;
  differentiate(fit_);
}

Prediction::Prediction(const models::Recording& recording, const models::Recording& validation, DrivenBy driven_by)
    : separate_(true), driven_by_(driven_by) {
  fit_.recording = recording;
  judge_.recording = validation;
  train_samples_ = recording.size();
  if (driven_by == DrivenBy::position) filter_.high_pass_Hz = 0;
  differentiate(fit_);
  differentiate(judge_);
}

void Prediction::set_motion_bandwidth(double bandwidth_Hz) {
  motion_bandwidth_Hz_ = bandwidth_Hz;
  differentiate(fit_);
  if (separate_) differentiate(judge_);
}

void Prediction::differentiate(Record& record) {
  if (driven_by_ != DrivenBy::position) return;
  const double h = record.recording.sample_time_s;
  record.grip.position_m = smoothed(record.recording.position_m, motion_bandwidth_Hz_, h);
  record.grip.velocity_m_per_s = derivative(record.grip.position_m, h);
  record.grip.acceleration_m_per_s2 = derivative(record.grip.velocity_m_per_s, h);
}

SimulationOptions Prediction::options(bool keep_motion) const {
  return {
      .sample_time_s = sample_time_s(), .hold = hold_, .initial = {}, .keep_motion = keep_motion, .start_time_s = 0.0};
}

bool Prediction::restarts(const models::AxisModel& model) const {
  // A plant that hardly returns by itself keeps every error it makes: judge it from a state of its own.
  if (driven_by_ != DrivenBy::force || model.base != models::BaseModel::msd) return false;
  const auto& [m, b, k] = model.msd;
  const double slow = b > 0 && k > 0 ? b / k + m / b : 1e9;
  return slow > 5.0;
}

Trajectory Prediction::run(const Record& record, const models::AxisModel& model, std::size_t from, std::size_t count,
                           bool keep_motion) const {
  auto settings = options(keep_motion);
  settings.start_time_s = static_cast<double>(from) * settings.sample_time_s;
  if (driven_by_ == DrivenBy::position) {
    if (from == 0 && count == record.grip.position_m.size()) return simulate_force(model, record.grip, settings);
    const GripMotion grip{slice(record.grip.position_m, from, count), slice(record.grip.velocity_m_per_s, from, count),
                          slice(record.grip.acceleration_m_per_s2, from, count)};
    return simulate_force(model, grip, settings);
  }
  const auto force = part(record.recording.force_N, from, count);
  if (model.base == models::BaseModel::msd) {
    // initial position and velocity by least squares over the first second
    const auto first = std::min<std::size_t>(count, static_cast<std::size_t>(1.0 / settings.sample_time_s));
    settings.keep_motion = false;
    settings.initial = {record.recording.position_m[from], 0.0};
    for (int pass = 0; pass < 2; ++pass) {
      const auto centre = simulate_position(model, force.first(first), settings);
      auto moved = settings;
      const double dx = 1e-4, dv = 1e-3;
      moved.initial.position_m += dx;
      const auto by_position = simulate_position(model, force.first(first), moved);
      moved = settings;
      moved.initial.velocity_m_per_s += dv;
      const auto by_velocity = simulate_position(model, force.first(first), moved);
      if (!centre.finite || !by_position.finite || !by_velocity.finite) break;
      Eigen::MatrixXd jacobian(first, 2);
      Eigen::VectorXd error(first);
      for (std::size_t i = 0; i < first; ++i) {
        const auto row = static_cast<Eigen::Index>(i);
        jacobian(row, 0) = (by_position.output[i] - centre.output[i]) / dx;
        jacobian(row, 1) = (by_velocity.output[i] - centre.output[i]) / dv;
        error[row] = record.recording.position_m[from + i] - centre.output[i];
      }
      const Eigen::Vector2d change = jacobian.colPivHouseholderQr().solve(error);
      settings.initial.position_m += change[0];
      settings.initial.velocity_m_per_s += change[1];
    }
    settings.keep_motion = keep_motion;
  }
  return simulate_position(model, force, settings);
}

Trajectory Prediction::run(const models::AxisModel& model, bool keep_motion, bool whole) const {
  return run(fit_, model, 0, whole ? fit_.recording.size() : train_samples_, keep_motion);
}

Trajectory Prediction::recorded_motion(const models::AxisModel& model) const {
  if (driven_by_ == DrivenBy::position) return run(model, true);
  constexpr double kBandwidth_Hz = 40.0;  // above it the derivative is noise
  const double h = sample_time_s();
  GripMotion grip;
  grip.position_m = smoothed(part(fit_.recording.position_m, 0, train_samples_), kBandwidth_Hz, h);
  grip.velocity_m_per_s = derivative(grip.position_m, h);
  grip.acceleration_m_per_s2 = derivative(grip.velocity_m_per_s, h);
  return identify::recorded_motion(model, grip, part(fit_.recording.force_N, 0, train_samples_), options(true));
}

std::vector<double> Prediction::filtered_train(std::span<const double> signal) const {
  const double h = sample_time_s();
  const auto filtered = high_passed(signal, filter_.high_pass_Hz, h);
  const auto skip = std::min(filtered.size() / 4, static_cast<std::size_t>(filter_.settle_s / h));
  const auto factor = static_cast<std::size_t>(std::max(1.0, std::floor(1 / (h * filter_.rate_Hz) + 1e-9)));
  return decimated(std::span(filtered).subspan(skip), factor);
}

std::vector<double> Prediction::train_residual(const models::AxisModel& model) const {
  const auto simulated = run(model, false);
  if (!simulated.finite) return {};
  std::vector<double> error(train_samples_);
  const auto& truth = output(fit_);
  for (std::size_t i = 0; i < error.size(); ++i) error[i] = truth[i] - simulated.output[i];
  return filtered_train(error);
}

std::vector<double> Prediction::full_error(const Record& record, const models::AxisModel& model,
                                           std::size_t from) const {
  const auto& truth = output(record);
  std::vector<double> error(truth.size(), std::nan(""));
  const auto fill = [&](std::size_t begin, std::size_t count) {
    const auto simulated = run(record, model, begin, count, false);
    if (!simulated.finite) return;
    for (std::size_t i = 0; i < count; ++i) error[begin + i] = truth[begin + i] - simulated.output[i];
  };
  if (from > 0 && restarts(model)) {
    fill(0, from);
    fill(from, truth.size() - from);
  } else {
    fill(0, truth.size());
  }
  return error;
}

std::vector<double> Prediction::validation_error(const models::AxisModel& model) const {
  const auto error = separate_ ? full_error(judge_, model, 0) : full_error(fit_, model, train_samples_);
  return slice(error, validation_start(), error.size() - validation_start());
}

Errors Prediction::errors(const models::AxisModel& model) const {
  const double h = sample_time_s();
  const auto train_error = full_error(fit_, model, separate_ ? 0 : train_samples_);
  const auto judged = separate_ ? full_error(judge_, model, 0) : train_error;
  const auto from = validation_start();
  Errors errors;
  const auto train = part(train_error, 0, train_samples_), held_out = part(judged, from, judged.size() - from);
  errors.rmse_train = rms(train);
  errors.rmse_validation = rms(held_out);
  const auto& truth = output(separate_ ? judge_ : fit_);
  errors.nrmse_validation = errors.rmse_validation / standard_deviation(part(truth, from, truth.size() - from));
  errors.finite = std::isfinite(errors.rmse_train) && std::isfinite(errors.rmse_validation);
  if (!errors.finite) return errors;

  errors.filtered_train = rms(filtered_train(train));
  const auto filtered = high_passed(judged, filter_.high_pass_Hz, h);
  const auto factor = static_cast<std::size_t>(std::max(1.0, std::floor(1 / (h * filter_.rate_Hz) + 1e-9)));
  const auto skip = from > 0 ? from : std::min(filtered.size() / 4, static_cast<std::size_t>(filter_.settle_s / h));
  const auto thinned = decimated(std::span(filtered).subspan(skip), factor);
  errors.filtered_validation = rms(thinned);
  // one second, or less where a short record would leave too few to tell a steady gain from a lucky one
  constexpr std::size_t kFewestBlocks = 16;
  const auto second = static_cast<std::size_t>(std::max(1.0, 1.0 / (h * static_cast<double>(factor))));
  const auto block = std::clamp<std::size_t>(thinned.size() / kFewestBlocks, 1, second);
  for (std::size_t i = 0; i + block <= thinned.size(); i += block) {
    const double value = rms(std::span(thinned).subspan(i, block));
    errors.blocks_validation.push_back(value * value);
  }
  return errors;
}

double diebold_mariano(const std::vector<double>& first, const std::vector<double>& second) {
  const std::size_t n = std::min(first.size(), second.size());
  if (n < 4) return 0.0;
  std::vector<double> difference(n);
  for (std::size_t i = 0; i < n; ++i) difference[i] = first[i] - second[i];
  const double centre = mean(difference);
  double variance = 0;
  constexpr std::size_t kLags = 2;
  for (std::size_t lag = 0; lag <= kLags; ++lag) {
    double covariance = 0;
    for (std::size_t i = lag; i < n; ++i) covariance += (difference[i] - centre) * (difference[i - lag] - centre);
    variance +=
        (lag == 0 ? 1.0 : 2.0 * (1 - static_cast<double>(lag) / (kLags + 1))) * covariance / static_cast<double>(n);
  }
  if (!(variance > 0)) return 0.0;
  return centre / std::sqrt(variance / static_cast<double>(n - 1));
}

}  // namespace handloop::identify
