#pragma once

#include <array>
#include <cstdint>

/// What stands between a controller's numbers and the device: encoders, converters, amplifier, motors and capstans.
/// Every function is real-time safe and without state; noise is the caller's.
namespace handloop::models {

/// Incremental encoder on a motor shaft.
struct Encoder {
  int counts_per_rev = 4096;  ///< HEDM-5500, 1024 lines, quadrature

  /// Whole counts passed at a shaft angle in rad (rounds down, as edges are counted), saturating at 32 bits.
  std::int32_t counts(double shaft_angle_rad) const;
  /// Shaft angle in rad of the last edge passed: at most one count below the true angle.
  double angle_rad(std::int32_t counts) const;
  double resolution_rad() const;
};

/// A converter of n bits whose codes 0 .. 2^n - 1 span -range to +range, ends included (as Comedi counts them): the
/// span has an even number of codes, so 0 V is not among them.
struct Converter {
  int bits = 12;
  double range_V = 10.0;

  std::uint32_t maximum_code() const { return (std::uint32_t{1} << bits) - 1; }
  /// Code nearest to a voltage, clipped at the ends; NaN gives the code nearest to 0 V from above.
  std::uint32_t code(double volt) const;
  /// Voltage of a code; codes beyond the last are clipped.
  double volt(std::uint32_t code) const;
  double step_V() const { return 2 * range_V / maximum_code(); }
};

/// Linear current amplifier.
struct Amplifier {
  double gain_A_per_V = 0.3;  ///< 3 A at 10 V
  double limit_A = 3.0;       ///< the arm paper's rig

  /// Current in A for a voltage, clipped at the limit.
  double current_A(double volt) const;
  /// Voltage that asks for a current; not clipped.
  double volt(double current_A) const { return current_A / gain_A_per_V; }
};

/// Maxon RE25 118743 as fitted to a Phantom Premium 1.5 built about 2000 (data sheet, by github.com/mahilab/Phantom).
struct Motor {
  double torque_constant_Nm_per_A = 0.0234;
  double resistance_ohm = 2.18;
  double inductance_H = 0.238e-3;
  double rotor_inertia_kg_m2 = 1.03e-6;  ///< data sheet; its mechanical time constant gives 1.068e-6
  double friction_Nm = 0.62e-3;          ///< from the no-load current of 26.3 mA
  double nominal_current_A = 1.24;
  double stall_current_A = 5.5;
};

/// Motors and cable capstans of the three joints.
struct PhantomDrive {
  Motor motor;
  std::array<double, 3> ratio{13.3, 11.2, 11.2};  ///< motor angle over joint angle

  /// Joint torque in Nm for a motor current in A, and back. joint is 0, 1 or 2.
  double joint_torque_Nm(int joint, double current_A) const {
    return ratio[static_cast<std::size_t>(joint)] * motor.torque_constant_Nm_per_A * current_A;
  }
  double current_A(int joint, double joint_torque_Nm) const {
    return joint_torque_Nm / (ratio[static_cast<std::size_t>(joint)] * motor.torque_constant_Nm_per_A);
  }
};

/// The one drive that was published.
constexpr PhantomDrive phantom_drive() {
  return {};
}

}  // namespace handloop::models
