#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "models/arm.h"
#include "models/axis.h"
#include "models/axis_model.h"
#include "models/phantom.h"
#include "models/seven_bar_arm.h"

/// What a scenario file says, as plain data: the device, the arm that holds it, the controller and the run. Reading and
/// writing is io/scenario_file.h; each key is documented in docs/scenarios.md. Defaults here are the defaults of the
/// file.
namespace handloop::models {

enum class DeviceModel { phantom_premium_1_5, seven_bar };

struct DeviceSettings {
  DeviceModel model = DeviceModel::phantom_premium_1_5;
  PhantomParameterSet parameter_set = PhantomParameterSet::cavusoglu;
  std::array<double, 3> pose_rad{0, 0, 0};  ///< motor angles q1, q2, q3 (absolute) at the start
  double stylus_mass_kg = 0.052;            ///< stylus and gimbal at the tip
  double joint_viscous_Nms_per_rad = 0.0005;
  double joint_coulomb_Nm = 0.0;         ///< free parameter: nothing was published for this device
  double structural_frequency_Hz = 0.0;  ///< of a two-mass mode in each capstan; 0: rigid
  double structural_damping_ratio = 0.02;
  bool counterbalanced = false;  ///< maker's counterweight on joint 2 for the gimbal
};

struct ElectronicsSettings {
  bool ideal = false;  ///< no quantisation, no saturation, no noise
  int encoder_counts_per_rev = 4096;
  int dac_bits = 12;
  double dac_range_V = 10.0;  ///< codes span -range..+range; 0 V is not a code
  double amplifier_A_per_V = 0.3;
  double current_limit_A = 3.0;
  int adc_bits = 16;
  double adc_range_V = 10.0;
  double force_sensor_N_per_V = 1.7;
  double force_noise_N = 0.003;  ///< standard deviation
  double grip_noise_N = 0.02;
  double grip_rate_Hz = 65.0;
};

enum class ForceSensedAt { grip, flange };

struct ArmSettings {
  bool attached = true;
  std::array<ArmParameters, 3> axes;  ///< by Axis; nominal (Table II) unless the file says otherwise
  /// A hand that is one with the stylus (base model `msd`): takes the place of the arm of that axis.
  std::array<std::optional<MsdParameters>, 3> rigid;
  std::vector<std::pair<Axis, EffectPtr>> effects;
  ForceSensedAt force_sensed_at = ForceSensedAt::grip;
  double grip_force_N = 2.0;
  double wander_rms_m = 0.0;  ///< slow voluntary motion
};

/// C(z) = K + B (1-a)/T (z-1)/(z-a), a = exp(-2 pi f_c T), negative feedback, `delay_samples` whole samples of delay.
struct LoopSettings {
  double stiffness_N_per_m = 400.0;
  double damping_Ns_per_m = 1.0;
  double sample_time_s = 0.001;
  int delay_samples = 1;
  double cutoff_Hz = 100.0;
};

struct WallSettings {
  Axis axis = Axis::z;
  double position_m = 0.0;  ///< along the axis, from the tip at the pose
  bool bilateral = false;   ///< a spring to the plane instead of a one-sided wall
  bool gravity_compensation = true;
};

struct SafetySettings {
  double force_limit_N = 5.0;
  double force_rate_limit_N_per_s = 5000.0;
  double velocity_limit_m_per_s = 2.0;
  double acceleration_limit_m_per_s2 = 400.0;  ///< of the tip, over about 5 ms
  double workspace_radius_m = 0.15;            ///< about the tip at the pose
  double energy_limit_J = 0.5;                 ///< that the wall may give the hand beyond what it received
  int watchdog_samples = 20;
  double joint_velocity_limit_rad_per_s = 30.0;
  double joint_acceleration_limit_rad_per_s2 = 6000.0;
  double contact_force_limit_N = 16.0;  ///< sensed, of hand and environment
  double model_torque_limit_Nm = 0.6;   ///< of a joint, that the mechanism's model does not explain
};

/// How the hand moves on its own: what makes the tip meet the wall in a run.
struct HandMotionSettings {
  Axis axis = Axis::z;
  double push_N = 2.0;         ///< mean force into the wall
  double disturbance_N = 0.0;  ///< rms of 30 Hz coloured noise added to it
};

/// Coefficients of s^3, s^2, s and 1.
using Cubic = std::array<double, 4>;

/// Force control of the seven-bar linkage (Kazerooni and Her): p_des = K (alpha f_h + f_e). Only for that device.
struct ForceAmplifierSettings {
  Cubic alpha_xx{0, 0, 0, 8}, alpha_xy{0, 0, 0, 0}, alpha_yx{0, 0, 0, 0}, alpha_yy{0, 0, 0, 5};
  Cubic alpha_denominator{0, 0, 0, 1};
  /// The paper gives no K: 0.0198 m/N/(0.03 s + 1)^3 is ours.
  Cubic filter_numerator_m_per_N{0, 0, 0, 0.0198};
  Cubic filter_denominator{2.7e-5, 2.7e-3, 0.09, 1};
  double inner_bandwidth_rad_per_s = 200.0;   ///< of the primary stabilising controller
  double performance_band_rad_per_s = 6.28;   ///< w_p of (8) and (9)
  double performance_tolerance = 0.01;        ///< epsilon
  double load_kg = 33.82 / 9.80665;           ///< at 0.5 m from the elbow
  SevenBarHand hand = SevenBarHand::printed;  ///< impedance of the arm at the handle
  double hand_rms_N = 12.0;                   ///< of the muscle force that moves it, irregular, each axis
  double hand_bandwidth_Hz = 0.5;
  double hand_cubic_N_per_m3 = 0.0;  ///< nonlinear Delta: a cubic spring of the hand
  double hand_leaves_s = 0.0;        ///< when the hand lets go; 0: never
};

struct RunSettings {
  double duration_s = 5.0;
  std::uint64_t seed = 1;
  double physics_step_s = 0.001;  ///< at most; shortened for fast arms
};

struct Scenario {
  std::string name = "phantom_wall";
  std::string description;
  DeviceSettings device;
  ElectronicsSettings electronics;
  ArmSettings arm;
  LoopSettings loop;
  WallSettings wall;
  SafetySettings safety;
  HandMotionSettings hand;
  ForceAmplifierSettings force_amplifier;
  RunSettings run;
};

}  // namespace handloop::models
