#pragma once

#include <array>
#include <initializer_list>
#include <limits>
#include <string_view>
#include <utility>

#include "models/scenario.h"

/// Every plain key of a scenario file, once: reader, writer and documentation all walk this list. To add a key, add its
/// field to models/scenario.h and one line here; then run the test with HANDLOOP_UPDATE_DOCS=1.
namespace handloop::io::detail {

/// Admissible numbers, both ends included; `above` excludes the lower end.
struct Range {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  bool above = false;
};

template <typename Enum>
using Words = std::initializer_list<std::pair<std::string_view, Enum>>;

inline constexpr std::array<std::pair<std::string_view, models::Axis>, 3> kAxisWords{
    {{"x", models::Axis::x}, {"y", models::Axis::y}, {"z", models::Axis::z}}};

/// Calls `table(name)`, then for each of its keys one of `text`, `flag`, `number`, `integer`, `numbers` and `choice`,
/// with key, field, admissible values and meaning. `Scenario` is const for a writer.
template <typename Scenario, typename Visitor>
void walk_scenario(Scenario& s, Visitor& v) {
  using models::DeviceModel, models::ForceSensedAt, models::PhantomParameterSet;
  v.table("", "The scenario itself");
  v.text("name", s.name, "short name, for reports");
  v.text("description", s.description, "what it is for, in a sentence");

  v.table("device", "The haptic device");
  v.choice("model", s.device.model,
           Words<DeviceModel>{{"phantom_premium_1_5", DeviceModel::phantom_premium_1_5},
                              {"seven_bar", DeviceModel::seven_bar}},
           "which device; the dimensions of the seven-bar linkage are an assumption of ours");
  v.choice("parameter_set", s.device.parameter_set,
           Words<PhantomParameterSet>{{"cavusoglu", PhantomParameterSet::cavusoglu}, {"cad", PhantomParameterSet::cad}},
           "inertial parameters of the Phantom: the published ones, or those of a CAD model as a perturbed plant");
  v.numbers("pose_rad", s.device.pose_rad, Range{-3.2, 3.2},
            "motor angles q1, q2, q3 at the start; margins are taken here");
  v.number("stylus_mass_kg", s.device.stylus_mass_kg, Range{0, 1}, "stylus and gimbal at the tip");
  v.number("joint_viscous_Nms_per_rad", s.device.joint_viscous_Nms_per_rad, Range{0, 1},
           "viscous friction of each joint");
  v.number("joint_coulomb_Nm", s.device.joint_coulomb_Nm, Range{0, 1},
           "dry friction of each joint; a free parameter, nothing was published");
  v.number("structural_frequency_Hz", s.device.structural_frequency_Hz, Range{0, 500},
           "of a flexible mode in each capstan; 0 for a rigid one; a free parameter");
  v.number("structural_damping_ratio", s.device.structural_damping_ratio, Range{0, 1}, "of that mode");
  v.flag("counterbalanced", s.device.counterbalanced, "with the maker's counterweight on joint 2 for the gimbal");

  v.table("electronics", "Encoders, converters, amplifiers and sensors");
  v.flag("ideal", s.electronics.ideal, "no quantisation, no saturation, no noise");
  v.integer("encoder_counts_per_rev", s.electronics.encoder_counts_per_rev, Range{16, 1e8},
            "of the motor's shaft, after quadrature");
  v.integer("dac_bits", s.electronics.dac_bits, Range{4, 24}, "resolution of the outputs");
  v.number("dac_range_V", s.electronics.dac_range_V, Range{0, 100, true},
           "codes span minus this to plus this; no code is 0 V");
  v.number("amplifier_A_per_V", s.electronics.amplifier_A_per_V, Range{0, 100, true}, "gain of the current amplifiers");
  v.number("current_limit_A", s.electronics.current_limit_A, Range{0, 100, true}, "of each amplifier");
  v.integer("adc_bits", s.electronics.adc_bits, Range{4, 24}, "resolution of the inputs");
  v.number("adc_range_V", s.electronics.adc_range_V, Range{0, 100, true}, "inputs span minus this to plus this");
  v.number("force_sensor_N_per_V", s.electronics.force_sensor_N_per_V, Range{0, 1000, true},
           "scale of the force sensor");
  v.number("force_noise_N", s.electronics.force_noise_N, Range{0, 10},
           "standard deviation of the force sensor's noise");
  v.number("grip_noise_N", s.electronics.grip_noise_N, Range{0, 10}, "standard deviation of the grip sensor's noise");
  v.number("grip_rate_Hz", s.electronics.grip_rate_Hz, Range{0, 1e5, true}, "at which the grip sensor is read");

  v.table("arm", "The arm that holds the device");
  v.flag("attached", s.arm.attached, "false: the device alone");
  v.choice("force_sensed_at", s.arm.force_sensed_at,
           Words<ForceSensedAt>{{"grip", ForceSensedAt::grip}, {"flange", ForceSensedAt::flange}},
           "grip: what the arm receives; flange: before stylus and gimbal, as in the paper's rig");
  v.number("grip_force_N", s.arm.grip_force_N, Range{0, 50}, "mean of the recorded grip force");
  v.number("wander_rms_m", s.arm.wander_rms_m, Range{0, 0.1}, "slow voluntary motion of the hand");

  v.table("loop", "The controller: C(z) = K + B (1-a)/T (z-1)/(z-a), a = exp(-2 pi f_c T)");
  v.number("stiffness_N_per_m", s.loop.stiffness_N_per_m, Range{0, 1e7}, "K");
  v.number("damping_Ns_per_m", s.loop.damping_Ns_per_m, Range{0, 1e5}, "B");
  v.number("sample_time_s", s.loop.sample_time_s, Range{1e-5, 0.1}, "T");
  v.integer("delay_samples", s.loop.delay_samples, Range{0, 1000}, "whole samples between reading and writing");
  v.number("cutoff_Hz", s.loop.cutoff_Hz, Range{0, 1e5, true}, "f_c, of the filter on the damping term");

  v.table("wall", "The virtual wall");
  v.choice("axis", s.wall.axis, kAxisWords, "across the wall: x left-right, y up-down, z forward-backward");
  v.number("position_m", s.wall.position_m, Range{-1, 1}, "along the axis, from the tip at the pose");
  v.flag("bilateral", s.wall.bilateral, "a spring to the plane, which pulls as well, in the place of a wall");
  v.flag("gravity_compensation", s.wall.gravity_compensation, "the controller carries the device's weight");

  v.table("safety", "Limits; crossing one latches a fault and takes the force away");
  v.number("force_limit_N", s.safety.force_limit_N, Range{0, 200, true}, "at the tip");
  v.number("force_rate_limit_N_per_s", s.safety.force_rate_limit_N_per_s, Range{0, 1e7, true},
           "of the commanded force");
  v.number("velocity_limit_m_per_s", s.safety.velocity_limit_m_per_s, Range{0, 100, true}, "of the tip");
  v.number("acceleration_limit_m_per_s2", s.safety.acceleration_limit_m_per_s2, Range{0, 1e5, true},
           "of the tip, over about 5 ms");
  v.number("workspace_radius_m", s.safety.workspace_radius_m, Range{0, 2, true}, "about the tip at the pose");
  v.number("energy_limit_J", s.safety.energy_limit_J, Range{0, 1e4, true},
           "that the wall may give the hand beyond what it received");
  v.integer("watchdog_samples", s.safety.watchdog_samples, Range{1, 1e6}, "without a fresh reading or command");

  v.number("joint_velocity_limit_rad_per_s", s.safety.joint_velocity_limit_rad_per_s, Range{0, 1e4, true},
           "of each joint");
  v.number("joint_acceleration_limit_rad_per_s2", s.safety.joint_acceleration_limit_rad_per_s2, Range{0, 1e7, true},
           "of each joint, over about 2 ms");
  v.number("contact_force_limit_N", s.safety.contact_force_limit_N, Range{0, 1e4, true},
           "sensed at the hand or at the environment");
  v.number("model_torque_limit_Nm", s.safety.model_torque_limit_Nm, Range{0, 1e4, true},
           "of a joint, that the model of the mechanism does not explain");

  v.table("hand", "How the hand moves of its own accord");
  v.choice("axis", s.hand.axis, kAxisWords, "along which it pushes");
  v.number("push_N", s.hand.push_N, Range{-50, 50}, "mean force, into the wall where positive");
  v.number("disturbance_N", s.hand.disturbance_N, Range{0, 50}, "rms of 30 Hz coloured noise added to it");

  auto& f = s.force_amplifier;
  const Range any{-1e12, 1e12};
  v.table("force_amplifier", "Force control of the seven-bar linkage, p_des = K (alpha f_h + f_e)");
  v.numbers("alpha_xx", f.alpha_xx, any, "force amplification forwards: numerator, coefficients of s^3, s^2, s and 1");
  v.numbers("alpha_xy", f.alpha_xy, any, "of an upward hand force, felt forwards");
  v.numbers("alpha_yx", f.alpha_yx, any, "of a forward hand force, felt upwards");
  v.numbers("alpha_yy", f.alpha_yy, any, "upwards");
  v.numbers("alpha_denominator", f.alpha_denominator, any, "common denominator of the four; R is the inverse of alpha");
  v.numbers("filter_numerator_m_per_N", f.filter_numerator_m_per_N, any,
            "of the stability filter K; the paper gives none, this one is ours");
  v.numbers("filter_denominator", f.filter_denominator, any, "of K");
  v.number("inner_bandwidth_rad_per_s", f.inner_bandwidth_rad_per_s, Range{1, 1e4},
           "of the primary stabilising controller");
  v.number("performance_band_rad_per_s", f.performance_band_rad_per_s, Range{0, 1e3, true},
           "w_p: the performance R is wanted from 0 to here");
  v.number("performance_tolerance", f.performance_tolerance, Range{0, 1, true}, "epsilon of that");
  v.number("load_kg", f.load_kg, Range{0, 20}, "environment: a mass 0.5 m from the elbow");
  v.choice("hand", f.hand,
           Words<models::SevenBarHand>{{"printed", models::SevenBarHand::printed},
                                       {"tight", models::SevenBarHand::tight},
                                       {"loose", models::SevenBarHand::loose}},
           "arm at the handle: the impedance H_0 as printed, or an arm with neural feedback, held tightly or loosely");
  v.number("hand_rms_N", f.hand_rms_N, Range{0, 500}, "rms of the irregular muscle force, along each axis");
  v.number("hand_bandwidth_Hz", f.hand_bandwidth_Hz, Range{0.02, 50}, "of it");
  v.number("hand_cubic_N_per_m3", f.hand_cubic_N_per_m3, Range{0, 1e9},
           "cubic spring of the hand, the nonlinear Delta");
  v.number("hand_leaves_s", f.hand_leaves_s, Range{0, 1e6}, "when the hand lets go of the handle; 0: never");

  v.table("run", "The run");
  v.number("duration_s", s.run.duration_s, Range{0, 1e6, true}, "of simulated or real time");
  v.integer("seed", s.run.seed, Range{0, 9e15}, "of all noise: the same seed, the same bytes");
  v.number("physics_step_s", s.run.physics_step_s, Range{1e-6, 0.1}, "at most; shortened for arms with fast poles");
}

}  // namespace handloop::io::detail
