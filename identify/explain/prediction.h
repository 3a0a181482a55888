#pragma once

#include <optional>
#include <vector>

#include "identify/explain/axis_simulation.h"
#include "models/recording.h"

namespace handloop::identify {

/// What counts as error while effects are selected: the error high-passed against slow wander, and thinned to a rate
/// that still holds everything the excitation reaches.
struct ErrorFilter {
  double high_pass_Hz = 0.5;
  double rate_Hz = 250.0;
  double settle_s = 1.0;  ///< left out at the start of a record
};

struct Errors {
  double rmse_train = 0.0;  ///< plain, nothing filtered, no mean removed
  double rmse_validation = 0.0;
  double nrmse_validation = 0.0;  ///< over the standard deviation of the measured output
  double filtered_train = 0.0;    ///< rms of the filtered error
  double filtered_validation = 0.0;
  std::vector<double> blocks_validation;  ///< mean square of the filtered held-out error, second by second; at least 16
  bool finite = true;
};

/// One recording (or two) seen as a prediction problem: what goes in, what comes out, which part is for fitting and
/// which is held out. Models are judged by free runs through it.
class Prediction {
 public:
  /// The last `held_out` share of the recording is for validation only.
  Prediction(const models::Recording& recording, DrivenBy driven_by, double held_out = 0.4);
  /// Everything of `recording` is for fitting, everything of `validation` for judging.
  Prediction(const models::Recording& recording, const models::Recording& validation, DrivenBy driven_by);

  DrivenBy driven_by() const { return driven_by_; }
  Hold hold() const { return hold_; }
  void set_hold(Hold hold) { hold_ = hold; }
  /// Bandwidth of the zero-phase filter through which measured motion becomes velocity and acceleration
  /// (position-driven).
  double motion_bandwidth_Hz() const { return motion_bandwidth_Hz_; }
  void set_motion_bandwidth(double bandwidth_Hz);
  const ErrorFilter& filter() const { return filter_; }
  void set_filter(const ErrorFilter& filter) { filter_ = filter; }

  double sample_time_s() const { return fit_.recording.sample_time_s; }
  std::size_t train_samples() const { return train_samples_; }
  const models::Recording& recording() const { return fit_.recording; }
  /// The record judged on: the same one, or the second.
  const models::Recording& validation_recording() const { return separate_ ? judge_.recording : fit_.recording; }
  std::size_t validation_start() const { return separate_ ? 0 : train_samples_; }
  const std::vector<double>& measured() const { return output(fit_); }
  const GripMotion& grip() const { return fit_.grip; }

  /// Free run over the fitting part; the whole recording where `whole` is set.
  Trajectory run(const models::AxisModel& model, bool keep_motion, bool whole = false) const;
  /// Motion over the fitting part as recorded, not simulated, where positions are predicted: what a missing effect
  /// really felt, noise included. Where forces are predicted, the same as run().
  Trajectory recorded_motion(const models::AxisModel& model) const;
  /// Measured minus simulated over the fitting part, filtered and thinned. Empty where the run diverged.
  std::vector<double> train_residual(const models::AxisModel& model) const;
  /// The same filter on any signal over the fitting part (length train_samples()).
  std::vector<double> filtered_train(std::span<const double> signal) const;
  /// Plain errors of the held-out part, sample by sample.
  std::vector<double> validation_error(const models::AxisModel& model) const;
  Errors errors(const models::AxisModel& model) const;
  SimulationOptions options(bool keep_motion) const;

 private:
  struct Record {
    models::Recording recording;
    GripMotion grip;
  };
  const std::vector<double>& output(const Record& record) const {
    return driven_by_ == DrivenBy::force ? record.recording.position_m : record.recording.force_N;
  }
  Trajectory run(const Record& record, const models::AxisModel& model, std::size_t from, std::size_t count,
                 bool keep_motion) const;
  bool restarts(const models::AxisModel& model) const;
  std::vector<double> full_error(const Record& record, const models::AxisModel& model, std::size_t from) const;
  void differentiate(Record& record);

  Record fit_, judge_;
  bool separate_ = false;
  DrivenBy driven_by_;
  Hold hold_ = Hold::first_order;
  double motion_bandwidth_Hz_ = 60.0;
  ErrorFilter filter_;
  std::size_t train_samples_ = 0;
};

/// Is the second model better? Diebold and Mariano's statistic on the blocks' losses (positive: the second is better),
/// with Newey-West variance over two lags; J. Business and Econ. Stat. 13 (1995) 253.
double diebold_mariano(const std::vector<double>& losses_first, const std::vector<double>& losses_second);

}  // namespace handloop::identify
