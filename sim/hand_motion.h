#pragma once

#include <array>
#include <cstdint>

#include "models/scenario.h"
#include "sim/coloured_noise.h"

namespace handloop::sim {

/// What the person does of their own will: slow wander of the resting body in every axis, and a muscle force on the
/// arm's mass along one. Real-time safe after construction.
class HandMotion {
 public:
  explicit HandMotion(const models::Scenario& scenario);

  struct Rest {
    std::array<double, 3> position_m{};
    std::array<double, 3> velocity_m_per_s{};
  };
  /// By arm axis. Sum of eight sines between 0.03 and 0.35 Hz of random phase, of the scenario's rms; starts at zero.
  Rest rest(double t_s) const;
  bool wanders() const { return wanders_; }

  void reset();
  /// Next sample's muscle forces: they go linearly from muscle_start to muscle_end within it.
  void next_sample(double t_start_s, double t_end_s);
  /// Along the axis of the motion, `share` of the way through the sample. The push sets in over half a second.
  double muscle_N(double share) const { return start_N_ + share * (end_N_ - start_N_); }
  models::Axis axis() const { return axis_; }

 private:
  double force_N(double t_s);

  static constexpr int kSines = 8;
  struct Sine {
    double rate, phase;
  };
  bool wanders_ = false;
  double amplitude_m_ = 0.0;
  std::array<std::array<Sine, kSines>, 3> sines_{};
  models::Axis axis_;
  double push_N_, disturbance_N_;
  ColouredNoise noise_;
  double start_N_ = 0.0, end_N_ = 0.0;
};

}  // namespace handloop::sim
