#include "control/force_control_primary.h"

#include <Eigen/LU>
#include <cmath>
#include <numbers>

#include "control/controllers/force_amplifier.h"
#include "control/controllers/seven_bar_mechanism.h"
#include "models/errors.h"

namespace handloop::control {
namespace {

using Complex = std::complex<double>;

models::SevenBarParameters device_at(const models::Scenario& scenario, const Eigen::Vector2d& th) {
  const auto device = seven_bar_of(scenario);
  if (std::abs(models::seven_bar_jacobian(device, th, device.handle_m).determinant()) < 1e-3) {
    throw InputError("scenario '" + scenario.name +
                     "': key device.pose_rad: links 3 and 6 are in line there; choose a pose with the elbow bent");
  }
  return device;
}

}  // namespace

ModelledPrimary::ModelledPrimary(const models::Scenario& scenario, const Eigen::Vector2d& th_rad)
    : bandwidth_(scenario.force_amplifier.inner_bandwidth_rad_per_s),
      sample_time_s_(scenario.loop.sample_time_s),
      delay_s_(scenario.loop.delay_samples * scenario.loop.sample_time_s) {
  const auto device = device_at(scenario, th_rad);
  mobility_per_kg_ = models::seven_bar_handle_mass(device, models::seven_bar_inertia(device), th_rad).inverse();
}

ModelledPrimary::Terms ModelledPrimary::terms(double w) const {
  const Complex jw(0, w), z = std::exp(jw * sample_time_s_);
  const double pole = std::exp(-2.0 * std::numbers::pi * ForceAmplifier::kVelocityCutoff_Hz * sample_time_s_);
  Terms t;
  t.hold = std::exp(-jw * delay_s_) * (1.0 - 1.0 / z) / (jw * sample_time_s_);
  t.feedback = 2.0 * bandwidth_ * (1.0 - pole) / sample_time_s_ * (z - 1.0) / (z - pole) + bandwidth_ * bandwidth_;
  t.denominator = jw * jw + t.hold * t.feedback;
  return t;
}

Eigen::Matrix2cd ModelledPrimary::to_hand(double w) const {
  const auto t = terms(w);
  return mobility_per_kg_.cast<Complex>() * ((1.0 - t.hold * sensing(w)) / t.denominator);
}

Eigen::Matrix2cd ModelledPrimary::to_environment(double w) const {
  return mobility_per_kg_.cast<Complex>() / terms(w).denominator;
}

std::complex<double> ModelledPrimary::sensing(double w) const {
  return std::exp(Complex(0, -0.5 * w * sample_time_s_));
}

Eigen::Matrix2cd ModelledPrimary::tracking(double w) const {
  const auto t = terms(w);
  return Eigen::Matrix2cd::Identity() * (t.hold * (-w * w + t.feedback) / t.denominator);
}

ForceControl force_control_of(const models::Scenario& scenario, const Eigen::Vector2d& th_rad) {
  ForceControl c;
  c.K = filter_of(scenario.force_amplifier);
  c.alpha = alpha_of(scenario.force_amplifier);
  c.environment_kg = models::seven_bar_environment_mass(device_at(scenario, th_rad), th_rad);
  // Rounding must not couple what is not coupled.
  if (std::abs(c.environment_kg(0, 1)) < 1e-9) c.environment_kg(0, 1) = c.environment_kg(1, 0) = 0.0;
  c.modelled_kg = c.environment_kg;
  return c;
}

}  // namespace handloop::control
