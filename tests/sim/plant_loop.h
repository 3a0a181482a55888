#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <numbers>
#include <vector>

#include "models/arm_tables.h"
#include "models/phantom.h"
#include "sim/phantom_plant.h"

/// What several tests of the plant share: a hand's controller that speaks codes, and frequency responses of records.
namespace handloop::sim::testing_support {

inline models::Scenario nominal_scenario() {
  models::Scenario scenario;
  for (const auto axis : models::kAxes) {
    scenario.arm.axes[static_cast<std::size_t>(axis)] = models::nominal_arm(axis);
  }
  scenario.hand.push_N = 0.0;
  scenario.electronics.ideal = true;
  return scenario;
}

inline std::uint32_t code_of(double value, double range, int bits) {
  const double top = std::ldexp(1.0, bits) - 1;
  return static_cast<std::uint32_t>(std::lround(std::clamp((value + range) / (2 * range) * top, 0.0, top)));
}

/// Codes for joint torques, straight from the description.
inline PlantCommand torque_command(const PlantDescription& plant, const Eigen::Vector3d& torque_Nm) {
  PlantCommand command;
  for (std::size_t i = 0; i < kMotors; ++i) {
    const double current =
        torque_Nm[static_cast<Eigen::Index>(i)] / (plant.transmission_ratio[i] * plant.torque_Nm_per_A[i]);
    command.dac_codes[i] = code_of(current / plant.amplifier_A_per_V, plant.dac_range_V, plant.dac_bits);
  }
  return command;
}

inline Eigen::Vector3d joint_angles(const PlantDescription& plant, const PlantReading& reading) {
  Eigen::Vector3d q;
  for (std::size_t i = 0; i < kMotors; ++i) {
    q[static_cast<Eigen::Index>(i)] = plant.encoder_zero_rad[i] + reading.encoder_counts[i] *
                                                                      plant.encoder_rad_per_count[i] /
                                                                      plant.transmission_ratio[i];
  }
  return q;
}

/// Runs the plant with a force at the tip (arm axes, N) given at every sample, gravity compensated; visit sees each
/// sample.
inline void push_with(PhantomPlant& plant, const models::Scenario& scenario, std::size_t samples,
                      const std::function<Eigen::Vector3d(std::size_t)>& force_N,
                      const std::function<void(std::size_t, const PhantomPlant&)>& visit) {
  const auto device = models::phantom_parameters(scenario.device.parameter_set, scenario.device.stylus_mass_kg);
  for (std::size_t k = 0; k < samples; ++k) {
    visit(k, plant);
    const auto q = joint_angles(plant.description(), plant.read());
    const Eigen::Vector3d arm = force_N(k);
    Eigen::Vector3d force;
    for (const auto axis : models::kAxes) force[models::device_row(axis)] = arm[static_cast<int>(axis)];
    const Eigen::Vector3d torque =
        models::phantom_jacobian(device, q).transpose() * force + models::phantom_gravity(device, q);
    plant.advance(torque_command(plant.description(), torque));
  }
}

/// One bin of a discrete Fourier transform: sum x[n] e^(-i 2 pi f n T).
inline std::complex<double> bin(const std::vector<double>& x, std::size_t from, double frequency_Hz, double T) {
  std::complex<double> sum = 0;
  for (std::size_t n = from; n < x.size(); ++n) {
    sum += x[n] * std::polar(1.0, -2 * std::numbers::pi * frequency_Hz * T * static_cast<double>(n - from));
  }
  return sum;
}

}  // namespace handloop::sim::testing_support
