#pragma once

#include <Eigen/Core>
#include <functional>
#include <memory>

#include "models/scenario.h"
#include "sim/phantom_plant.h"

struct mjModel_;
struct mjData_;

/// The seven-bar linkage as its electronics show it: DAC codes in, resolver counts and ADC codes out. Inside is
/// scenes/seven_bar.xml with the load at the environment sensor and an arm's impedance at the handle.
///
/// Motors 0 and 1 set th3 and th6. Analog inputs: 0, 1 force on the hand along link 6 and across it; 2, 3 the same for
/// the load, its weight included; 4 grip on the handle. Vectors of SevenBarTruth are x forward, y up.
namespace handloop::sim {

inline constexpr std::size_t kSevenBarMotors = 2;
inline constexpr std::size_t kSevenBarAnalogInputs = 5;
inline constexpr double kSevenBarGrip_N = 12.0;  ///< of a hand that holds the handle

/// What really happens, for logs and tests; never for a controller.
struct SevenBarTruth {
  double t_s = 0.0;
  Eigen::Vector2d joint_rad = Eigen::Vector2d::Zero();
  Eigen::Vector2d joint_rad_per_s = Eigen::Vector2d::Zero();
  Eigen::Vector2d handle_m = Eigen::Vector2d::Zero();  ///< from where it was at the pose
  Eigen::Vector2d handle_m_per_s = Eigen::Vector2d::Zero();
  Eigen::Vector2d muscle_force_N = Eigen::Vector2d::Zero();       ///< u_h, or the intended force f_i of a neural arm
  Eigen::Vector2d hand_force_N = Eigen::Vector2d::Zero();         ///< f_h, on the device
  Eigen::Vector2d environment_force_N = Eigen::Vector2d::Zero();  ///< of the load on the device at the load, weight in
  Eigen::Vector2d torque_Nm = Eigen::Vector2d::Zero();            ///< of the motors, held since the last sample
  std::array<bool, 2> switched_off{};                             ///< a limit switch has cut the motor's current
  double loop_gap_m = 0.0;                                        ///< how far the four-bars stand open
  bool held = false;                                              ///< by a hand
  bool diverged = false;  ///< a state left the finite numbers; the plant stands still since
};

/// Forces from outside, N, x forward, y up, at a time in s: what tests and studies push with.
using OutsideForce = std::function<Eigen::Vector2d(double)>;

/// One plant. The same scenario and commands give the same bits. Not shared between threads.
class SevenBarPlant {
 public:
  /// Throws InputError where the scenario asks for what cannot be simulated.
  explicit SevenBarPlant(const models::Scenario& scenario, const PlantOptions& options = {});
  ~SevenBarPlant();
  SevenBarPlant(SevenBarPlant&&) noexcept;
  SevenBarPlant& operator=(SevenBarPlant&&) noexcept;

  const PlantDescription& description() const;
  /// The present sample. Real-time safe.
  PlantReading read() const noexcept;
  /// Holds the command for one sample time. Real-time safe.
  void advance(const PlantCommand& command) noexcept;
  /// Back to the first sample.
  void reset() noexcept;
  SevenBarTruth truth() const noexcept;

  /// The muscle force in the place of the scenario's irregular one.
  void set_muscle_force(OutsideForce force);
  /// On the load, beside its own inertia and weight: f_ext of (3).
  void set_environment_force(OutsideForce force);
  /// The scenario's own irregular muscle force.
  Eigen::Vector2d scenario_muscle_force_N(double t_s) const;

  const mjModel_* mujoco_model() const;
  mjData_* picture();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace handloop::sim
