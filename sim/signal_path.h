#pragma once

#include <Eigen/Core>
#include <vector>

#include "models/effects/effect.h"

namespace handloop::sim {

/// The effects on one signal in a row: y = transfer(s) u(t - delay) + addition(t). The transfer is carried exactly
/// between steps over which its input is linear in time. The delay is the caller's to apply, before the transfer.
/// Real-time safe after construction.
class SignalPath {
 public:
  SignalPath() = default;
  /// Takes the effects that act on a signal at this place. Throws InputError where a transfer is improper (more zeros
  /// than poles): it cannot be simulated.
  SignalPath(const std::vector<models::EffectPtr>& effects, models::Place place, double step_s);

  bool empty() const { return effects_.empty(); }
  double delay_s() const { return delay_s_; }
  double addition(double t_s) const;

  void reset();
  /// One step with the input going from `from` to `to`. Afterwards output(to) is what leaves at its end.
  void step(double from, double to);
  double output(double input) const;

 private:
  struct Section {
    Eigen::MatrixXd transition;
    Eigen::VectorXd from_gain, to_gain, state, scratch;
    Eigen::RowVectorXd read;
    double direct = 1.0;
    double output(double input) const { return read * state + direct * input; }
  };
  std::vector<models::EffectPtr> effects_;
  std::vector<Section> sections_;
  double delay_s_ = 0.0;
};

}  // namespace handloop::sim
