#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "device/device.h"
#include "models/scenario.h"
#include "sim/phantom_plant.h"

namespace handloop::control {
class Mechanism;
class VirtualWall;
}  // namespace handloop::control

namespace handloop::studies {

/// What the MuJoCo plant does after a push against the wall.
struct TimeDomainVerdict {
  bool stable = false;
  double growth_per_sample = 0.0;  ///< factor of the motion's size, by the last second; below 1: it dies out
  double swing_m = 0.0;            ///< peak to peak along the axis, at the end
  bool saturated = false;          ///< the current limit was met after the push
  std::uint64_t samples = 0;
};

/// The linear question in the time domain: the stylus rests on a bilateral wall through the tip, is pushed so that the
/// wall answers with about 2.4 N, and either comes to rest or does not. Encoders, converters, currents, delay and arm
/// are the scenario's; its hand is still, its wall is everywhere.
class TimeDomainLoop {
 public:
  /// Throws InputError where the scenario cannot be simulated.
  explicit TimeDomainLoop(const models::Scenario& scenario);
  ~TimeDomainLoop();

  /// Allocates nothing once the loop is made. Ends as soon as the answer is clear, after 10 s of simulated time at
  /// most.
  ///
  /// The size of the motion is the rms velocity of the tip in windows of 0.25 s. With ideal electronics stable means
  /// that it fell to a ten-thousandth of the first window, unstable that it grew to three times that. Real electronics
  /// leave a motion of a few encoder counts for ever: there stable means that the motion halved since the second
  /// window, or swings by less than 0.1 mm, unstable that it grew by half or still rings at the current limit after 2
  /// s. Failing all, the motion of the last two windows is compared with the second: what shrank is stable even where
  /// it locked into a limit cycle of the encoder counts, whose size is `swing_m`.
  TimeDomainVerdict judge(double stiffness_N_per_m, double damping_Ns_per_m);

  /// Samples of the plant that judge() has run so far.
  std::uint64_t samples() const { return samples_; }
  const sim::PhantomPlant& plant() const { return plant_; }

 private:
  bool sample(bool push);

  models::Scenario scenario_;
  sim::PhantomPlant plant_;
  device::DeviceDescription description_;
  std::unique_ptr<control::Mechanism> mechanism_;
  std::unique_ptr<control::VirtualWall> wall_;
  std::vector<sim::PlantCommand> line_;  ///< commands that wait out the delay
  std::size_t head_ = 0;
  std::uint64_t samples_ = 0;
};

/// The scenario as TimeDomainLoop needs it: bilateral wall at the tip, hand at rest.
models::Scenario still_scenario(models::Scenario scenario, models::Axis axis);

}  // namespace handloop::studies
