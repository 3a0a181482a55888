#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>

#include "models/scenario.h"
#include "sim/pull.h"

struct mjModel_;
struct mjData_;

/// The simulated device as its electronics show it: DAC codes in, encoder counts and ADC codes out, one sample at a
/// time. Inside is the MuJoCo scene of the Phantom and, at its stylus, the arm of each axis with its effects.
///
/// Frames: device frame x fore-aft, y lateral, z up; arm axes as in models/axis.h. Signs: motor angles and torques are
/// those of models' q1, q2, q3 (all ratios positive); forces are those the device exerts on the hand.
namespace handloop::sim {

inline constexpr std::size_t kMotors = 3;
inline constexpr std::size_t kAnalogInputs = 8;
/// Analog inputs in use: force x, y, z of the device frame, grip force.
inline constexpr std::size_t kAnalogInputsUsed = 4;

/// What one sample reads; a function of the plant's state and the sample's number alone.
struct PlantReading {
  std::uint64_t sample = 0;
  std::array<std::int32_t, kMotors> encoder_counts{};
  std::array<std::uint32_t, kAnalogInputs> adc_codes{};  ///< offset binary, 0 .. 2^bits - 1 spans -range .. +range
};

/// DAC codes, offset binary: volts = -range + code 2 range/(2^bits - 1). No code is exactly 0 V.
struct PlantCommand {
  std::array<std::uint32_t, kMotors> dac_codes{};
};

/// Scales and signs of counts and codes; the same meanings as device::DeviceDescription. An ideal plant
/// (electronics.ideal) has converters of 30 bits over +-100 V, 2^28 counts a turn, no noise and a current limit out of
/// reach, so that whoever speaks to it need not know.
struct PlantDescription {
  std::array<double, kMotors> encoder_rad_per_count{};  ///< motor shaft
  std::array<double, kMotors> encoder_zero_rad{};       ///< joint angle at count 0: the pose of the start
  std::array<double, kMotors> transmission_ratio{};     ///< motor turns per joint turn
  std::array<double, kMotors> torque_Nm_per_A{};        ///< at the motor shaft
  double amplifier_A_per_V = 0.0;
  double current_limit_A = 0.0;
  int dac_bits = 12;
  double dac_range_V = 10.0;
  int adc_bits = 16;
  double adc_range_V = 10.0;
  std::array<double, kAnalogInputs> analog_N_per_V{};
  double sample_time_s = 0.001;
  double physics_step_s = 0.001;  ///< chosen: RunSettings' or shorter, an integer fraction of the sample
};

/// What really happens, for logs, panels and tests; never for a controller. Arrays by models::Axis unless said
/// otherwise.
struct PlantTruth {
  double t_s = 0.0;
  std::array<double, 3> tip_m{};  ///< grip, from where it was at the pose
  std::array<double, 3> tip_m_per_s{};
  std::array<double, 3> hand_force_N{};     ///< through the grasp, on the hand
  std::array<double, 3> flange_force_N{};   ///< through the device's flange, on stylus and hand; gravity tared; only
                                            ///< where a scenario senses it
  std::array<double, 3> arm_mass_m{};       ///< of the arm's mass, from its rest
  double grip_force_N = 0.0;                ///< pinch on the stylus
  std::array<double, kMotors> joint_rad{};  ///< by motor
  std::array<double, kMotors> joint_rad_per_s{};
  std::array<double, kMotors> motor_current_A{};  ///< held since the last sample
  double loop_gap_m = 0.0;                        ///< how far the parallelogram stands open
  bool diverged = false;                          ///< a state left the finite numbers; the plant stands still since
};

struct PlantOptions {
  bool with_visuals =
      false;  ///< keep the shapes in the MuJoCo model, for whoever draws it; the physics is the same bits
};

/// One plant. Not shared between threads; any number of plants may run in as many threads. The same scenario (seed
/// included) and commands give the same bits.
class PhantomPlant {
 public:
  /// Loads scenes/phantom.xml. Throws InputError where the scenario asks for what cannot be simulated.
  explicit PhantomPlant(const models::Scenario& scenario, const PlantOptions& options = {});
  ~PhantomPlant();
  PhantomPlant(PhantomPlant&&) noexcept;
  PhantomPlant& operator=(PhantomPlant&&) noexcept;

  const PlantDescription& description() const;

  /// The present sample, number 0 at the start. Real-time safe; may be asked more than once.
  PlantReading read() const noexcept;
  /// Takes the command of the present sample, holds it and moves on by one sample time. The plant has no delay of its
  /// own: the loop's delay belongs to whoever closes it. Real-time safe: neither allocates, locks nor throws.
  void advance(const PlantCommand& command) noexcept;
  /// Pulls at the stylus from now on, until told otherwise or reset(). Real-time safe.
  void set_pull(const Pull& pull) noexcept;
  /// Back to the first sample. Real-time safe.
  void reset() noexcept;

  /// Real-time safe.
  PlantTruth truth() const noexcept;

  /// Kinetic energy of device and arms and what the arms' springs hold, J; gravity and effects left out.
  double energy_J();

  /// For drawing: the MuJoCo model and data with the person's picture and the wall posed as of now. The data is scratch
  /// of this plant: read it between calls of advance(), on the same thread.
  const mjModel_* mujoco_model() const;
  mjData_* picture();

  struct Impl;

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace handloop::sim
