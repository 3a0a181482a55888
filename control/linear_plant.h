#pragma once

#include <Eigen/Core>
#include <complex>
#include <vector>

#include "control/margins.h"
#include "models/axis_model.h"

/// The sampled loop about a plant with effects: any AxisModel, its effects by their linear stand-ins at an operating
/// point, held by a device. Slower than control/margins.h (milliseconds), for plants that five parameters do not
/// describe.
namespace handloop::control {

/// x' = A x + B u(t - delay), y = C x: force in N at the grip to position in m.
struct LinearPlant {
  Eigen::MatrixXd A;
  Eigen::VectorXd B;
  Eigen::RowVectorXd C;
  double delay_s = 0.0;  ///< of actuator and sensor together, kept exact when sampled

  /// Frequency response at s in rad/s, delay included.
  std::complex<double> operator()(std::complex<double> s) const;
};

/// Device (tip mass and damping) and model with its effects. Rational effects become states; a delay inside the plant
/// (a reflex) becomes an all-pass of Pade's whose order keeps its phase to 1e-6 rad up to 300 rad/s (as far as order 24
/// allows); delays of actuator and sensor stay exact. Throws InputError for an effect that cannot be linearised so (a
/// signal effect that differentiates, a delayed mass).
LinearPlant linear_plant(const models::AxisModel& model, const models::AxisOperatingPoint& point, double tip_mass_kg,
                         double tip_damping_Ns_per_m);

/// The plant behind a hold, its delay split into whole samples and a rest (Astrom and Wittenmark, Computer-Controlled
/// Systems, 3.2): x+ = Phi x + Gamma0 u[k - n] + Gamma1 u[k - n - 1].
class SampledLinearPlant {
 public:
  SampledLinearPlant(const LinearPlant& plant, double sample_time_s);

  /// P at a point z = 1 + delta off the poles, delay included.
  std::complex<double> operator()(std::complex<double> delta) const;
  double sample_time_s() const { return sample_time_s_; }
  int whole_delay_samples() const { return whole_delay_; }
  const Eigen::VectorXcd& poles() const { return poles_; }  ///< in z, delay left out

  const Eigen::MatrixXd& phi() const { return phi_; }
  const Eigen::VectorXd& gamma0() const { return gamma0_; }
  const Eigen::VectorXd& gamma1() const { return gamma1_; }
  const Eigen::RowVectorXd& output() const { return output_; }

 private:
  double sample_time_s_;
  int whole_delay_ = 0;
  Eigen::MatrixXd phi_;
  Eigen::VectorXd gamma0_, gamma1_;
  Eigen::RowVectorXd output_;
  // in the basis of the Schur form, where a response costs one triangular solution
  Eigen::MatrixXcd triangle_;
  Eigen::VectorXcd input0_, input1_;
  Eigen::RowVectorXcd out_;
  Eigen::VectorXcd poles_;
};

/// Poles of the loop closed over the plant, in z.
Eigen::VectorXcd closed_loop_poles(const SampledLinearPlant& plant, const LoopTiming& timing, const WallGains& gains);

/// Poles and margins, as evaluate of control/margins.h. Throws InputError where timing is not possible.
Margins evaluate(const SampledLinearPlant& plant, const LoopTiming& timing, const WallGains& gains);

/// The same from a model: sampled and judged.
Margins evaluate(const models::AxisModel& model, const models::AxisOperatingPoint& point, double tip_mass_kg,
                 double tip_damping_Ns_per_m, const LoopTiming& timing, const WallGains& gains);

/// Frequency responses at one frequency, 0 to pi/T.
LoopResponse loop_response(const SampledLinearPlant& plant, const LoopTiming& timing, const WallGains& gains,
                           double frequency_rad_per_s);

}  // namespace handloop::control
