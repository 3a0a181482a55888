#include "identify/sampled_arm.h"

#include <ceres/jet.h>

#include <cmath>

namespace handloop::identify {

using Complex = std::complex<double>;
using Jet = ceres::Jet<double, 5>;

namespace {

/// exp(-damping) cosh(sqrt(d)) and exp(-damping) sinh(sqrt(d))/sqrt(d), for d of either sign, damping >= sqrt(d) where
/// d > 0.
struct DampedPair {
  Jet c, s;
};

DampedPair damped_pair(const Jet& damping, const Jet& d) {
  if (std::abs(d.a) < 1e-3) {
    // Series about equal poles: six terms leave less than 1e-24.
    Jet c(1.0), s(1.0), even(1.0), odd(1.0);
    for (int n = 1; n <= 6; ++n) {
      even = even * d / static_cast<double>((2 * n - 1) * (2 * n));
      odd = odd * d / static_cast<double>((2 * n) * (2 * n + 1));
      c += even;
      s += odd;
    }
    const Jet decay = exp(-damping);
    return {decay * c, decay * s};
  }
  if (d.a < 0) {
    const Jet w = sqrt(-d), decay = exp(-damping);
    return {decay * cos(w), decay * sin(w) / w};
  }
  // Both exponents are negative: nothing overflows however fast the faster pole is.
  const Jet root = sqrt(d), slow = exp(root - damping), fast = exp(-root - damping);
  return {0.5 * (slow + fast), 0.5 * (slow - fast) / root};
}

}  // namespace

std::string_view hold_name(Hold hold) {
  return std::array<std::string_view, 3>{"continuous", "zero_order", "first_order"}[static_cast<std::size_t>(hold)];
}

SampledArm::SampledArm(const models::ArmParameters& arm, Hold hold, double sample_time_s)
    : arm_(arm), hold_(hold), sample_time_s_(sample_time_s) {
  if (hold == Hold::continuous) return;
  const double T = sample_time_s;
  const Jet mass(arm.mass_kg, 0), k1(arm.k1_N_per_m, 1), k2(arm.k2_N_per_m, 2), b1(arm.b1_Ns_per_m, 3),
      b2(arm.b2_Ns_per_m, 4);
  auto keep = [](const Jet& jet) {
    Coefficient c;
    c.value = jet.a;
    for (int i = 0; i < 5; ++i) c.by[static_cast<std::size_t>(i)] = jet.v[i];
    return c;
  };

  // Grasp: 1/(k1 + b1 s), one decay a sample. Far beyond the exponential's range it is a mere spring (exp(-700) is
  // 1e-304, and the derivative of what is 0 must be 0, not infinity times 0).
  const bool spring = arm.k1_N_per_m * T > 700 * arm.b1_Ns_per_m;
  const Jet e = spring ? Jet(0.0) : exp(-k1 * T / b1);
  if (hold == Hold::zero_order) {
    g1_ = keep(Jet(0.0));
    g0_ = keep((1.0 - e) / k1);
  } else {
    const Jet share = (1.0 - e) * b1 / (k1 * T);
    g1_ = keep((1.0 - share) / k1);
    g0_ = keep((share - e) / k1);
  }
  e_ = keep(e);

  // Arm: states position and velocity; Phi = exp(A T) in closed form.
  const Jet sigma = b2 / (2.0 * mass), stiffness = k2 / mass;
  const auto pair = damped_pair(sigma * T, (sigma * sigma - stiffness) * (T * T));
  const Jet C = pair.c, S = pair.s * T;
  const Jet phi11 = C + sigma * S, phi22 = C - sigma * S;
  const Jet step_x = (1.0 - phi11) / k2, step_v = S / mass;  // response at T to a constant force of 1 N
  if (hold == Hold::zero_order) {
    n2_ = keep(Jet(0.0));
    n1_ = keep(step_x);
    n0_ = keep(S * step_v - phi22 * step_x);
  } else {
    // Gamma1 = A^-1 (Gamma0 - T B)/T: response at T to a force that rises from 0 to 1 N.
    const Jet ramp_x = (-b2 * step_x - mass * step_v + T) / (k2 * T), ramp_v = step_x / T;
    const Jet fall_x = step_x - ramp_x, fall_v = step_v - ramp_v;
    n2_ = keep(ramp_x);
    n1_ = keep(fall_x + S * ramp_v - phi22 * ramp_x);
    n0_ = keep(S * fall_v - phi22 * fall_x);
  }
  a1_ = keep(-2.0 * C);
  a2_ = keep(exp(-2.0 * sigma * T));
}

Complex SampledArm::operator()(double w) const {
  if (hold_ == Hold::continuous) return models::compliance(arm_, Complex(0, w));
  const Complex z = std::polar(1.0, w * sample_time_s_);
  return (g1_.value * z + g0_.value) / (z - e_.value) +
         ((n2_.value * z + n1_.value) * z + n0_.value) / ((z + a1_.value) * z + a2_.value);
}

Complex SampledArm::gradient(double w, std::array<Complex, 5>& derivative) const {
  if (hold_ == Hold::continuous) {
    const Complex s(0, w);
    const Complex grasp = 1.0 / (arm_.b1_Ns_per_m * s + arm_.k1_N_per_m);
    const Complex rest = 1.0 / ((arm_.mass_kg * s + arm_.b2_Ns_per_m) * s + arm_.k2_N_per_m);
    const Complex by_grasp = -grasp * grasp, by_rest = -rest * rest;
    derivative = {by_rest * s * s, by_grasp, by_rest, by_grasp * s, by_rest * s};
    return grasp + rest;
  }
  const Complex z = std::polar(1.0, w * sample_time_s_);
  const Complex below_grasp = 1.0 / (z - e_.value), below_arm = 1.0 / ((z + a1_.value) * z + a2_.value);
  const Complex grasp = (g1_.value * z + g0_.value) * below_grasp;
  const Complex rest = ((n2_.value * z + n1_.value) * z + n0_.value) * below_arm;
  for (std::size_t i = 0; i < 5; ++i) {
    derivative[i] = (g1_.by[i] * z + g0_.by[i] + grasp * e_.by[i]) * below_grasp +
                    ((n2_.by[i] * z + n1_.by[i]) * z + n0_.by[i] - rest * (a1_.by[i] * z + a2_.by[i])) * below_arm;
  }
  return grasp + rest;
}

std::vector<double> SampledArm::simulate(std::span<const double> force_N) const {
  if (hold_ == Hold::continuous) return SampledArm(arm_, Hold::first_order, sample_time_s_).simulate(force_N);
  std::vector<double> position(force_N.size());
  double f1 = 0, f2 = 0, grasp = 0, arm1 = 0, arm2 = 0;
  for (std::size_t n = 0; n < position.size(); ++n) {
    const double f = force_N[n];
    grasp = e_.value * grasp + g1_.value * f + g0_.value * f1;
    const double arm = -a1_.value * arm1 - a2_.value * arm2 + n2_.value * f + n1_.value * f1 + n0_.value * f2;
    position[n] = grasp + arm;
    f2 = f1;
    f1 = f;
    arm2 = arm1;
    arm1 = arm;
  }
  return position;
}

}  // namespace handloop::identify
