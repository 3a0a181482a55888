#include "tests/support/planted_plant.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace handloop::tests {
namespace {

double sign(double v) {
  return v > 0 ? 1.0 : v < 0 ? -1.0 : 0.0;
}
double dead_zone(double x, double width) {
  const double half = width / 2;
  return x > half ? x - half : x < -half ? x + half : 0.0;
}

enum Index { iX, iV, iG, iW, iBristle, iMaxwell, iReflex1, iReflex2, iAbsX, iAbsV, iModeX, iModeV, iLag, kStates };
using State = std::array<double, kStates>;

/// Inputs of one evaluation.
struct Inputs {
  double force = 0, tremor = 0, body = 0, body_rate = 0, reflex = 0, time = 0;
};

class Runner {
 public:
  Runner(const Plant& plant, const Drive& drive) : p_(plant), d_(drive) {}

  std::vector<double> run(std::vector<double>* applied);

 private:
  double force_at(double sample) const;
  double linear_at(const std::vector<double>& signal, double sample) const;
  double drifted(Plant::Drifts which, double value, double time) const;
  double arm_resistance(const State& s, const Inputs& in, bool with_friction, double& bristle_rate) const;
  void rates(const State& s, const Inputs& in, State& r) const;
  double acceleration_without_friction(const State& s, const Inputs& in) const;
  double grip_force(const State& s, const Inputs& in, double& grasp_rate, double& grip_acceleration) const;
  double friction_level(double v) const;

  const Plant& p_;
  const Drive& d_;
  bool stuck_ = false;  // exact stick-slip
  double slip_sign_ = 0;
};

double Runner::force_at(double sample) const {
  const auto n = static_cast<std::ptrdiff_t>(d_.force.size());
  const auto at = [&](std::ptrdiff_t i) {
    return i < 0 ? 0.0 : d_.force[static_cast<std::size_t>(std::min(i, n - 1))];
  };
  const double base = std::floor(sample + 1e-9);
  const auto i = static_cast<std::ptrdiff_t>(base);
  if (d_.held) return at(i);
  const double u = sample - base;
  const double a = at(i - 1), b = at(i), c = at(i + 1), e = at(i + 2);
  return b + 0.5 * u * (c - a + u * (2 * a - 5 * b + 4 * c - e + u * (3 * (b - c) + e - a)));
}

double Runner::linear_at(const std::vector<double>& signal, double sample) const {
  if (signal.empty()) return 0;
  const double base = std::floor(sample);
  const auto i = std::min(static_cast<std::size_t>(std::max(base, 0.0)), signal.size() - 1);
  const auto j = std::min(i + 1, signal.size() - 1);
  return signal[i] + (sample - base) * (signal[j] - signal[i]);
}

double Runner::drifted(Plant::Drifts which, double value, double time) const {
  if (p_.drifts != which) return value;
  const double t = std::max(time, 0.0);
  double shape = 0;
  switch (p_.drift_shape) {
    case Plant::DriftShape::linear:
      shape = t / p_.drift_duration;
      break;
    case Plant::DriftShape::exponential:
      shape = 1 - std::exp(-t / p_.drift_time);
      break;
    case Plant::DriftShape::step:
      shape = 0.5 + 0.5 * std::tanh((t - 0.5 * p_.drift_duration) / p_.drift_time);
      break;
  }
  return value * (1 + p_.drift_amount * shape);
}

double Runner::friction_level(double v) const {
  if (p_.breakaway_excess == 0) return p_.friction_force;
  const double r = v / p_.stribeck_velocity;
  return p_.friction_force + p_.breakaway_excess * std::exp(-r * r);
}

/// Everything that resists the mass, except the grasp; the bristle's rate on the side.
double Runner::arm_resistance(const State& s, const Inputs& in, bool with_friction, double& bristle_rate) const {
  const double x = s[iX], v = s[iV];
  const double k2 = drifted(Plant::Drifts::k2, p_.k2, in.time), b2 = drifted(Plant::Drifts::b2, p_.b2, in.time);
  const double lean = x - in.body;
  double f = k2 * (p_.arm_freeplay > 0 ? dead_zone(lean, p_.arm_freeplay) : lean) + b2 * (v - in.body_rate);
  f += p_.drag * std::abs(v) * v + p_.cubic_arm * x * x * x;
  if (p_.side_stiffness != 0)
    f += p_.side_stiffness *
         (p_.side_corner > 0 ? 0.5 * (x + std::sqrt(x * x + p_.side_corner * p_.side_corner)) - 0.5 * p_.side_corner
                             : std::max(x, 0.0));
  if (p_.ripple_force != 0 && !p_.ripple_at_grip)
    f += p_.ripple_force * std::sin(2 * std::numbers::pi * x / p_.ripple_period + p_.ripple_phase);
  if (!p_.maxwell_in_grasp) f += s[iMaxwell];
  f += s[p_.reflex_order == 2 ? iReflex2 : iReflex1];
  f -= p_.tremor_force * in.tremor;
  if (p_.gravity_moment != 0) f += p_.gravity_moment * std::sin(x + p_.gravity_angle);
  if (p_.absorber_mass > 0) {
    const double stiffness = p_.absorber_mass * p_.absorber_rate * p_.absorber_rate;
    const double damping = 2 * p_.absorber_damping * p_.absorber_rate * p_.absorber_mass;
    f += stiffness * (x - s[iAbsX]) + damping * (v - s[iAbsV]);
  }
  if (p_.stop_stiffness > 0) {
    if (x > p_.stop_at) f += p_.stop_stiffness * (x - p_.stop_at);
    if (p_.stop_two_sided && x < -p_.stop_at) f += p_.stop_stiffness * (x + p_.stop_at);
  }
  f += p_.absx_damping * std::abs(x) * v + p_.x2_damping * x * x * v + p_.speed_stiffness * std::abs(v) * x;
  if (p_.absx_friction != 0) f += p_.absx_friction * std::abs(x) * std::tanh(v / p_.smoothing_velocity);
  if (p_.saturating_force != 0) f += p_.saturating_force * std::tanh(x / p_.saturating_length);
  if (p_.forward_stiffness != 0) f += p_.forward_stiffness * x * (0.5 + 0.5 * std::tanh(v / p_.smoothing_velocity));
  if (p_.root_damping != 0) f += p_.root_damping * v / std::sqrt(std::sqrt(v * v + 1e-8));
  bristle_rate = 0;
  if (p_.bw_force != 0) {
    const double z = s[iBristle], za = std::abs(z);
    const double power = p_.bw_exponent == 1 ? za : p_.bw_exponent == 2 ? za * za : std::pow(za, p_.bw_exponent);
    const double power_1z = za > 0 ? power * sign(z) : 0;
    bristle_rate = (v - p_.bw_beta * std::abs(v) * power_1z - p_.bw_gamma * v * power) / p_.bw_length;
    f += p_.bw_force * z;
  }
  if (with_friction) {
    switch (p_.friction) {
      case Plant::Friction::none:
        break;
      case Plant::Friction::smooth:
        f += friction_level(v) * std::tanh(v / p_.smoothing_velocity);
        break;
      case Plant::Friction::exact:
        f += friction_level(v) * slip_sign_;
        break;
      case Plant::Friction::bristle:
        bristle_rate = v / p_.bristle_length - std::abs(v) / p_.bristle_length * s[iBristle];
        f += friction_level(v) * s[iBristle];
        break;
    }
  }
  return f;
}

/// Force that the grasp hands to the mass.
double Runner::grip_force(const State& s, const Inputs& in, double& grasp_rate, double& grip_acceleration) const {
  const double g = s[iG];
  if (p_.k1 == 0) {
    grasp_rate = grip_acceleration = 0;
    return in.force + p_.force_offset;
  }
  const double k1 = drifted(Plant::Drifts::k1, p_.k1, in.time);
  double outside = in.force + p_.force_offset;
  if (p_.ripple_force != 0 && p_.ripple_at_grip)
    outside -= p_.ripple_force * std::sin(2 * std::numbers::pi * (s[iX] + g) / p_.ripple_period + p_.ripple_phase);
  double spring = k1 * (p_.gap > 0 ? dead_zone(g, p_.gap) : g) + p_.cubic_grasp * g * g * g;
  if (p_.maxwell_in_grasp) spring += s[iMaxwell];
  if (p_.grip_mass > 0) {
    grasp_rate = s[iW] - s[iV];
    const double grasp = spring + p_.b1 * grasp_rate;
    grip_acceleration = (outside - grasp) / p_.grip_mass;
    return grasp;
  }
  grip_acceleration = 0;
  grasp_rate = (outside - spring) / p_.b1;
  return outside;
}

double Runner::acceleration_without_friction(const State& s, const Inputs& in) const {
  double grasp_rate = 0, grip_acceleration = 0, bristle_rate = 0;
  const double grasp = grip_force(s, in, grasp_rate, grip_acceleration);
  return grasp - arm_resistance(s, in, false, bristle_rate);
}

void Runner::rates(const State& s, const Inputs& in, State& r) const {
  double grasp_rate = 0, grip_acceleration = 0, bristle_rate = 0;
  const double grasp = grip_force(s, in, grasp_rate, grip_acceleration);
  const double resistance = arm_resistance(s, in, true, bristle_rate);
  const double mass = drifted(Plant::Drifts::M, p_.M, in.time);
  r[iX] = s[iV];
  r[iV] = stuck_ ? 0.0 : (grasp - resistance) / mass;
  r[iG] = grasp_rate;
  r[iW] = grip_acceleration;
  r[iBristle] = bristle_rate;
  r[iMaxwell] = p_.maxwell_stiffness == 0
                    ? 0
                    : p_.maxwell_stiffness * (p_.maxwell_in_grasp ? grasp_rate : s[iV]) - s[iMaxwell] / p_.maxwell_time;
  r[iReflex1] = p_.reflex_gain == 0 ? 0 : p_.reflex_rate * (p_.reflex_gain * in.reflex - s[iReflex1]);
  r[iReflex2] = p_.reflex_rate * (s[iReflex1] - s[iReflex2]);
  if (p_.absorber_mass > 0) {
    r[iAbsX] = s[iAbsV];
    r[iAbsV] =
        p_.absorber_rate * (p_.absorber_rate * (s[iX] - s[iAbsX]) + 2 * p_.absorber_damping * (s[iV] - s[iAbsV]));
  } else {
    r[iAbsX] = r[iAbsV] = 0;
  }
  r[iModeX] = s[iModeV];
  r[iModeV] = p_.mode_compliance == 0 ? 0
                                      : p_.mode_rate * p_.mode_rate * (p_.mode_compliance * in.force - s[iModeX]) -
                                            2 * p_.mode_damping * p_.mode_rate * s[iModeV];
  r[iLag] = p_.lag_time > 0 ? (s[iX] + s[iG] - s[iLag]) / p_.lag_time : 0;
}

std::vector<double> Runner::run(std::vector<double>* applied) {
  const std::size_t count = d_.force.size();
  const int n = d_.steps_per_sample;
  const double h = d_.sample_time_s / n;
  const bool exact = p_.friction == Plant::Friction::exact;
  const double delay_steps = std::round(p_.transport_delay / h);
  const auto reflex_steps = static_cast<std::size_t>(std::max(2.0, std::round(p_.reflex_delay / h)));
  std::vector<double> past(p_.reflex_gain != 0 ? reflex_steps + 1 : 0, 0.0);  // ring of what the reflex senses
  std::size_t head = 0;
  const auto sensed = [&](double value) {
    if (!p_.reflex_rectified) return value;
    return std::max(p_.reflex_direction * value, 0.0) * p_.reflex_direction;
  };

  const double limit = p_.k1 == 0 ? 10.0 : 0.5;  // m or rad: beyond this it has diverged
  State s{};
  std::vector<double> out;
  out.reserve(count - d_.lead_in);
  for (std::size_t i = 0; i < count; ++i) {
    if (i >= d_.lead_in) out.push_back(p_.lag_time > 0 ? s[iLag] : s[iX] + s[iG] + s[iModeX]);
    if (!(std::abs(s[iX]) < limit) || !(std::abs(s[iG]) < limit)) return {};
    double servo = 0;
    if (!d_.reference.empty()) servo = d_.servo_stiffness * (d_.reference[i] - s[iX]) - d_.servo_damping * s[iV];
    if (applied && i >= d_.lead_in) applied->push_back(servo + force_at(static_cast<double>(i)));
    for (int k = 0; k < n; ++k) {
      const double step = static_cast<double>(i) * n + k;
      Inputs in[3];
      for (int m = 0; m < 3; ++m) {
        const double at = step + 0.5 * m;
        in[m].force = d_.held ? force_at((step - delay_steps) / n) : force_at((at - delay_steps) / n);
        in[m].force += servo;
        in[m].tremor = linear_at(d_.tremor, at / n);
        in[m].time = at * h - static_cast<double>(d_.lead_in) * d_.sample_time_s;
        if (!d_.equilibrium.empty()) {
          in[m].body = linear_at(d_.equilibrium, at / n);
          in[m].body_rate = (linear_at(d_.equilibrium, at / n + 1) - in[m].body) / d_.sample_time_s;
        }
      }
      if (!past.empty()) {  // the ring holds what was sensed at the last reflex_steps + 1 step starts
        past[head] = p_.reflex_of_position ? s[iX] : s[iV];
        const std::size_t oldest = (head + 1) % past.size(), next = (head + 2) % past.size();
        in[0].reflex = sensed(past[oldest]);
        in[2].reflex = sensed(past[next]);
        in[1].reflex = 0.5 * (in[0].reflex + in[2].reflex);
        head = oldest;
      }
      if (exact) {
        const double level = friction_level(0);
        if (s[iV] == 0) {
          const double drive = acceleration_without_friction(s, in[0]);
          stuck_ = std::abs(drive) <= level;
          slip_sign_ = stuck_ ? 0 : sign(drive);
        } else {
          stuck_ = false;
          slip_sign_ = sign(s[iV]);
        }
      }
      State r1, r2, r3, r4, t;
      rates(s, in[0], r1);
      for (int j = 0; j < kStates; ++j) t[j] = s[j] + 0.5 * h * r1[j];
      rates(t, in[1], r2);
      for (int j = 0; j < kStates; ++j) t[j] = s[j] + 0.5 * h * r2[j];
      rates(t, in[1], r3);
      for (int j = 0; j < kStates; ++j) t[j] = s[j] + h * r3[j];
      rates(t, in[2], r4);
      for (int j = 0; j < kStates; ++j) s[j] += h / 6 * (r1[j] + 2 * (r2[j] + r3[j]) + r4[j]);
      if (exact && !stuck_ && slip_sign_ != 0 && s[iV] * slip_sign_ < 0) s[iV] = 0;  // it came to rest within the step
      if (p_.bw_force != 0 || p_.friction == Plant::Friction::bristle) s[iBristle] = std::clamp(s[iBristle], -1.5, 1.5);
    }
  }
  return out;
}

}  // namespace

std::vector<double> run_plant(const Plant& plant, const Drive& drive, std::vector<double>* applied) {
  return Runner(plant, drive).run(applied);
}

}  // namespace handloop::tests
