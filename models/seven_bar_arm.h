#pragma once

#include <complex>
#include <string_view>

#include "models/seven_bar.h"

/// The human arm of Kazerooni and Her's appendix: the muscles' intended force f_i comes out of the activation dynamics
/// G_a, driven by the command m less the neural feedback G_f of the contact force; muscles and passive tissue G_p take
/// G_p p away from it:
///     f_i = G_a (m - G_f f_h),  f_h = f_i - G_p p,  so  f_h = G_cns m - H p,  H = G_p/(1 + G_f G_a)        (A4-A6)
/// G_a = 1/(t_a s + 1), G_p = M s^2 + B s + K (A2), G_f = C e^(-s t_d)/(s + lambda) (A3) with the neural delay.
/// Both signs of p and f are those of models/seven_bar.h. Real-time safe.
namespace handloop::models {

struct NeuralArm {
  double mass_kg = 4.0418;
  double damping_Ns_per_m = 34.76107;
  double stiffness_N_per_m = 176.5862;
  double activation_s = 0.05;            ///< t_a
  double feedback_gain_rad_per_s = 0.0;  ///< C
  double feedback_pole_rad_per_s = 2.0;  ///< lambda, bandwidth of the central nervous system
  double neural_delay_s = 0.05;          ///< t_d

  std::complex<double> activation(std::complex<double> s) const { return 1.0 / (activation_s * s + 1.0); }
  std::complex<double> tissue(std::complex<double> s) const {
    return (mass_kg * s + damping_Ns_per_m) * s + stiffness_N_per_m;
  }
  std::complex<double> feedback(std::complex<double> s) const {
    return feedback_gain_rad_per_s * std::exp(-s * neural_delay_s) / (s + feedback_pole_rad_per_s);
  }
  /// H of (A6), N/m.
  std::complex<double> impedance(std::complex<double> s) const {
    return tissue(s) / (1.0 + feedback(s) * activation(s));
  }
  /// G_cns of (A5), N of contact force per N of command.
  std::complex<double> command(std::complex<double> s) const {
    return activation(s) / (1.0 + feedback(s) * activation(s));
  }
};

/// Which arm holds the handle.
enum class SevenBarHand {
  printed,  ///< H_0 of (18) itself, without neural dynamics
  tight,    ///< a tight grip by the appendix: weak feedback, H within 0.6 dB and 4 deg of H_0 (0.1-100 rad/s)
  loose     ///< a loose grip: strong feedback, so that the hand yields at low frequency and keeps its mass at high
};

/// The paper gives no values for G_a, G_p and G_f ("we do not plan to arrive at the values"); these are ours. `printed`
/// is the arm without feedback.
NeuralArm neural_arm(SevenBarHand hand);
std::string_view hand_name(SevenBarHand hand);

}  // namespace handloop::models
