#include "identify/explain/axis_simulation.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>

#include "identify/explain/discretise.h"
#include "identify/explain/place_effects.h"
#include "identify/explain/signals.h"

namespace handloop::identify {
namespace {

using models::AxisModel;
using models::BaseModel;
using models::Place;

constexpr double kSmallestDamping = 1e-9;  // a massless grip without a damper has no rate of its own

/// Sum of what the signal effects of a model do.
struct SignalChain {
  double actuator_delay_s = 0, sensor_delay_s = 0, force_offset_N = 0, position_offset_m = 0;
  std::vector<double> actuator_lags_s, sensor_lags_s;

  explicit SignalChain(const AxisModel& model) {
    for (const auto& effect : model.effects) {
      if (!effect->acts_on_signal()) continue;
      const bool actuator = effect->place() == Place::actuator;
      (actuator ? actuator_delay_s : sensor_delay_s) += effect->delay_s();
      (actuator ? force_offset_N : position_offset_m) += effect->signal_addition(0.0);
      const auto linear = effect->linearise({}, {});
      if (linear.denominator.size() == 2) (actuator ? actuator_lags_s : sensor_lags_s).push_back(linear.denominator[0]);
    }
  }
};

/// The linear part under a force at the grip: x' = A x + B u, u = (grip force, grasp extra, arm extra), the extras
/// resisting. States: msd (x, v); massless grip (grasp extension, arm position, arm velocity); with mass at the grip
/// (grip position, grip velocity, arm position, arm velocity).
class ForceDrivenPlant {
 public:
  ForceDrivenPlant(const AxisModel& model, double grip_mass_kg, double arm_mass_kg, double h_s) {
    using Eigen::Matrix2d, Eigen::MatrixXd;
    transition_.setZero();
    at_start_.setZero();
    at_end_.setZero();
    if (model.base == BaseModel::msd) {
      layout_ = Layout::msd;
      const double m = model.msd.mass_kg + arm_mass_kg + grip_mass_kg;
      MatrixXd a{{0.0, 1.0}, {-model.msd.k_N_per_m / m, -model.msd.b_Ns_per_m / m}};
      MatrixXd b{{0.0, 0.0, 0.0}, {1 / m, 0.0, -1 / m}};
      place(discretise(a, b, h_s), 0);
      return;
    }
    const auto& arm = model.arm;
    const double m2 = arm.mass_kg + arm_mass_kg;
    if (grip_mass_kg > 0) {
      layout_ = Layout::grip_mass;
      const double m1 = grip_mass_kg, k1 = arm.k1_N_per_m, b1 = arm.b1_Ns_per_m;
      MatrixXd a{{0.0, 1.0, 0.0, 0.0},
                 {-k1 / m1, -b1 / m1, k1 / m1, b1 / m1},
                 {0.0, 0.0, 0.0, 1.0},
                 {k1 / m2, b1 / m2, -(k1 + arm.k2_N_per_m) / m2, -(b1 + arm.b2_Ns_per_m) / m2}};
      MatrixXd b{{0.0, 0.0, 0.0}, {1 / m1, -1 / m1, 0.0}, {0.0, 0.0, 0.0}, {0.0, 1 / m2, -1 / m2}};
      place(discretise(a, b, h_s), 0);
      return;
    }
    layout_ = Layout::massless_grip;
    k1_ = arm.k1_N_per_m;
    b1_ = std::max(arm.b1_Ns_per_m, kSmallestDamping);
    const auto grasp = discretise_decay(k1_ / b1_, 1 / b1_, h_s);
    transition_(0, 0) = grasp.transition;
    at_start_(0, 0) = grasp.at_start;
    at_start_(0, 1) = -grasp.at_start;
    at_end_(0, 0) = grasp.at_end;
    at_end_(0, 1) = -grasp.at_end;
    MatrixXd a{{0.0, 1.0}, {-arm.k2_N_per_m / m2, -arm.b2_Ns_per_m / m2}};
    MatrixXd b{{0.0, 0.0, 0.0}, {1 / m2, 0.0, -1 / m2}};
    place(discretise(a, b, h_s), 1);
  }

  using State = Eigen::Vector4d;
  using Input = Eigen::Vector3d;

  State start(const InitialState& initial) const {
    if (layout_ == Layout::msd) return {initial.position_m, initial.velocity_m_per_s, 0, 0};
    if (layout_ == Layout::massless_grip) return {0, initial.position_m, initial.velocity_m_per_s, 0};
    return {initial.position_m, initial.velocity_m_per_s, initial.position_m, initial.velocity_m_per_s};
  }
  /// What one more newton of arm effect at the end of the step does to the state there.
  State arm_force_influence() const { return at_end_.col(2); }
  State step(const State& x, const Input& u0, const Input& u1) const {
    if (layout_ != Layout::massless_grip) return transition_ * x + at_start_ * u0 + at_end_ * u1;
    // most of the time goes here: only what is not zero
    const double grasp0 = u0[0] - u0[1], grasp1 = u1[0] - u1[1], arm0 = u0[0] - u0[2], arm1 = u1[0] - u1[2];
    return {transition_(0, 0) * x[0] + at_start_(0, 0) * grasp0 + at_end_(0, 0) * grasp1,
            transition_(1, 1) * x[1] + transition_(1, 2) * x[2] + at_start_(1, 0) * arm0 + at_end_(1, 0) * arm1,
            transition_(2, 1) * x[1] + transition_(2, 2) * x[2] + at_start_(2, 0) * arm0 + at_end_(2, 0) * arm1, 0.0};
  }
  double grip_position(const State& x) const { return layout_ == Layout::massless_grip ? x[0] + x[1] : x[0]; }
  double arm_position(const State& x) const {
    return layout_ == Layout::msd ? x[0] : layout_ == Layout::massless_grip ? x[1] : x[2];
  }
  double arm_velocity(const State& x) const {
    return layout_ == Layout::msd ? x[1] : layout_ == Layout::massless_grip ? x[2] : x[3];
  }
  double grasp_extension(const State& x) const {
    return layout_ == Layout::msd ? 0 : layout_ == Layout::massless_grip ? x[0] : x[0] - x[2];
  }
  double grasp_velocity(const State& x, const Input& u) const {
    if (layout_ == Layout::msd) return 0;
    return layout_ == Layout::massless_grip ? (u[0] - u[1] - k1_ * x[0]) / b1_ : x[1] - x[3];
  }
  double grip_velocity(const State& x, const Input& u) const {
    return layout_ == Layout::massless_grip ? x[2] + grasp_velocity(x, u) : x[1];
  }
  bool massless_grip() const { return layout_ == Layout::massless_grip; }

 private:
  enum class Layout { msd, massless_grip, grip_mass };
  void place(const LinearStep& step, Eigen::Index at) {
    const auto n = step.transition.rows();
    transition_.block(at, at, n, n) = step.transition;
    at_start_.block(at, 0, n, 3) = step.at_start;
    at_end_.block(at, 0, n, 3) = step.at_end;
  }

  Layout layout_ = Layout::msd;
  double k1_ = 0, b1_ = 1;
  Eigen::Matrix4d transition_;
  Eigen::Matrix<double, 4, 3> at_start_, at_end_;
};

/// How fast the steepest effect at the arm answers, 1/s: beyond a fraction of the step its force is solved for, not
/// predicted.
double fastest_rate(const models::LinearElement& steepest, double mass_kg) {
  return steepest.damping_Ns_per_m / mass_kg + std::sqrt(steepest.stiffness_N_per_m / mass_kg);
}

double place_mass(const AxisModel& model, Place place) {
  double mass = 0;
  for (const auto& effect : model.effects) {
    if (effect->place() == place) mass += effect->added_mass_kg(0.0);
  }
  return mass;
}

std::vector<double> actuated(std::span<const double> force, const SignalChain& chain, double sample_time_s) {
  std::vector<double> out(force.begin(), force.end());
  if (chain.actuator_delay_s > 0) out = delayed(out, chain.actuator_delay_s, sample_time_s);
  for (const double lag : chain.actuator_lags_s) out = lagged(out, lag, sample_time_s);
  for (double& value : out) value += chain.force_offset_N;
  return out;
}

void sense(std::vector<double>& position, const SignalChain& chain, double sample_time_s) {
  if (chain.sensor_delay_s > 0) position = delayed(position, chain.sensor_delay_s, sample_time_s);
  for (const double lag : chain.sensor_lags_s) position = lagged(position, lag, sample_time_s);
  if (chain.position_offset_m != 0) {
    for (double& value : position) value += chain.position_offset_m;
  }
}

}  // namespace

const PlaceMotion& Trajectory::at(Place place) const {
  if (place == Place::grasp) return grasp;
  return place == Place::joint ? joint : arm;
}

Trajectory simulate_position(const AxisModel& model, std::span<const double> force_N,
                             const SimulationOptions& options) {
  const SignalChain chain(model);
  const bool changed = chain.actuator_delay_s > 0 || !chain.actuator_lags_s.empty() || chain.force_offset_N != 0;
  const std::vector<double> shaped = changed ? actuated(force_N, chain, options.sample_time_s) : std::vector<double>{};
  const std::span<const double> force = changed ? std::span<const double>(shaped) : force_N;

  const std::size_t samples = force.size();
  const double grip_mass = place_mass(model, Place::grasp) + place_mass(model, Place::joint);
  const double arm_mass = place_mass(model, Place::arm);
  const double inertia = (model.base == BaseModel::msd ? model.msd.mass_kg : model.arm.mass_kg) + arm_mass;
  const auto effects_at = [&](Place place, double h, std::size_t steps) {
    return PlaceEffects(model, place, h, steps, options.start_time_s);
  };
  const double rate =
      fastest_rate(effects_at(Place::arm, options.sample_time_s, 1).steepest(), inertia) * options.sample_time_s;
  // behind a massless grip the grasp answers at k1/b1, and so must an effect that takes its spring away
  const bool fast_grasp = model.base == BaseModel::arm5 && !effects_at(Place::grasp, options.sample_time_s, 1).empty();
  const double grasp_rate =
      fast_grasp ? model.arm.k1_N_per_m / std::max(model.arm.b1_Ns_per_m, kSmallestDamping) * options.sample_time_s
                 : 0.0;
  const auto substeps = static_cast<std::size_t>(std::clamp(std::ceil(grasp_rate / 0.25), rate > 4.0 ? 2.0 : 1.0, 8.0));
  const bool implicit = rate > 0.3;
  const double h = options.sample_time_s / static_cast<double>(substeps);
  PlaceEffects arm = effects_at(Place::arm, h, samples * substeps),
               grasp = effects_at(Place::grasp, h, samples * substeps),
               joint = effects_at(Place::joint, h, samples * substeps);
  const bool nonlinear = !arm.empty() || !grasp.empty() || !joint.empty();
  const ForceDrivenPlant plant(model, grip_mass, arm_mass, h);

  Trajectory run;
  run.output.resize(samples);
  if (options.keep_motion) {
    for (auto* motion : {&run.arm, &run.grasp, &run.joint}) motion->resize(samples);
  }
  auto x = plant.start(options.initial);
  Eigen::Vector3d u(samples > 0 ? force[0] : 0.0, 0.0, 0.0);
  double arm_acceleration = 0, grip_acceleration = 0;
  // forces of the effects at a state; at a massless grip velocity and force depend on each other: two damped passes
  const auto evaluate = [&](std::size_t step, double f, const Eigen::Vector4d& state, Eigen::Vector3d input) {
    input[0] = f + (input[0] - f) * (joint.empty() ? 0.0 : 1.0);
    for (int pass = 0; pass < (plant.massless_grip() && (!joint.empty() || !grasp.empty()) ? 2 : 1); ++pass) {
      const double share = pass == 0 ? 1.0 : 0.5;
      if (!grasp.empty()) {
        const double force_grasp =
            grasp.force_N(step, plant.grasp_extension(state), plant.grasp_velocity(state, input), 0.0);
        input[1] += share * (force_grasp - input[1]);
      }
      if (!joint.empty()) {
        const double force_joint =
            joint.force_N(step, plant.grip_position(state), plant.grip_velocity(state, input), grip_acceleration);
        input[0] += share * (f - force_joint - input[0]);
      }
    }
    if (!arm.empty())
      input[2] = arm.force_N(step, plant.arm_position(state), plant.arm_velocity(state), arm_acceleration);
    return input;
  };
  for (std::size_t i = 0; i < samples; ++i) {
    run.output[i] = plant.grip_position(x);
    if (options.keep_motion) {
      run.arm.x_m[i] = plant.arm_position(x);
      run.arm.v_m_per_s[i] = plant.arm_velocity(x);
      run.grasp.x_m[i] = plant.grasp_extension(x);
      run.grasp.v_m_per_s[i] = plant.grasp_velocity(x, u);
      run.joint.x_m[i] = plant.grip_position(x);
      run.joint.v_m_per_s[i] = plant.grip_velocity(x, u);
    }
    if (i + 1 == samples) break;
    const double end = options.hold == Hold::zero_order ? force[i] : force[i + 1];
    if (!nonlinear) {
      x = plant.step(x, {force[i], 0, 0}, {end, 0, 0});
      continue;
    }
    if (options.hold == Hold::zero_order) u[0] += i == 0 ? 0.0 : force[i] - force[i - 1];
    for (std::size_t s = 0; s < substeps; ++s) {
      const std::size_t step = i * substeps + s;
      const double f1 = force[i] + (end - force[i]) * static_cast<double>(s + 1) / static_cast<double>(substeps);
      const double f0 = force[i] + (end - force[i]) * static_cast<double>(s) / static_cast<double>(substeps);
      arm.remember(step, plant.arm_position(x), plant.arm_velocity(x));
      grasp.remember(step, plant.grasp_extension(x), plant.grasp_velocity(x, u));
      joint.remember(step, plant.grip_position(x), plant.grip_velocity(x, u));
      Eigen::Vector3d ahead(u[0] + f1 - f0, u[1], u[2]);
      const auto predicted = plant.step(x, u, ahead);
      arm.advance(step, plant.arm_position(x), plant.arm_velocity(x), plant.arm_position(predicted),
                  plant.arm_velocity(predicted));
      grasp.advance(step, plant.grasp_extension(x), plant.grasp_velocity(x, u), plant.grasp_extension(predicted),
                    plant.grasp_velocity(predicted, ahead));
      joint.advance(step, plant.grip_position(x), plant.grip_velocity(x, u), plant.grip_position(predicted),
                    plant.grip_velocity(predicted, ahead));
      const double assumed = ahead[2];
      ahead = evaluate(step + 1, f1, predicted, ahead);
      auto corrected = plant.step(x, u, ahead);
      if (implicit) {
        // the force must be that of the motion it leads to: the law falls along its own influence, so the secant closes
        // in
        const auto influence = plant.arm_force_influence();
        double below = assumed, below_rest = ahead[2] - assumed, at = ahead[2];
        for (int pass = 0; pass < 8; ++pass) {
          corrected = predicted + influence * (at - assumed);
          const double law =
              arm.force_N(step + 1, plant.arm_position(corrected), plant.arm_velocity(corrected), arm_acceleration);
          const double rest = law - at;
          if (std::abs(rest) < 1e-7 * (1.0 + std::abs(at)) || below_rest == rest) break;
          const double next = at - rest * (at - below) / (rest - below_rest);
          below = at;
          below_rest = rest;
          at = next;
        }
        ahead[2] = at;
        corrected = plant.step(x, u, ahead);
      }
      arm_acceleration = (plant.arm_velocity(corrected) - plant.arm_velocity(x)) / h;
      grip_acceleration = (plant.grip_velocity(corrected, ahead) - plant.grip_velocity(x, u)) / h;
      x = corrected;
      u = ahead;
    }
    if (!(std::abs(run.output[i]) < 1e6)) {
      run.finite = false;
      return run;
    }
  }
  sense(run.output, chain, options.sample_time_s);
  run.finite = run.output.empty() || std::isfinite(run.output.back());
  return run;
}

Trajectory simulate_force(const AxisModel& model, const GripMotion& recorded, const SimulationOptions& options) {
  const SignalChain chain(model);
  const std::size_t samples = recorded.position_m.size();
  const double h = options.sample_time_s;
  // The record shows the grip late and lagged: look ahead and invert the lag.
  GripMotion shifted;
  const GripMotion* grip = &recorded;
  const double late = chain.actuator_delay_s + chain.sensor_delay_s;
  double lag = 0;
  for (const auto* lags : {&chain.actuator_lags_s, &chain.sensor_lags_s}) {
    for (const double value : *lags) lag += value;
  }
  if (late > 0 || lag > 0 || chain.position_offset_m != 0) {
    shifted = recorded;
    if (late > 0) {
      for (auto* signal : {&shifted.position_m, &shifted.velocity_m_per_s, &shifted.acceleration_m_per_s2})
        *signal = delayed(*signal, -late, h);
    }
    if (lag > 0) {
      const auto jerk = derivative(shifted.acceleration_m_per_s2, h);
      for (std::size_t i = 0; i < samples; ++i) {
        shifted.position_m[i] += lag * shifted.velocity_m_per_s[i];
        shifted.velocity_m_per_s[i] += lag * shifted.acceleration_m_per_s2[i];
        shifted.acceleration_m_per_s2[i] += lag * jerk[i];
      }
    }
    for (double& value : shifted.position_m) value -= chain.position_offset_m;
    grip = &shifted;
  }
  PlaceEffects arm(model, Place::arm, h, samples, options.start_time_s),
      grasp(model, Place::grasp, h, samples, options.start_time_s),
      joint(model, Place::joint, h, samples, options.start_time_s);
  const double grip_mass = place_mass(model, Place::grasp) + place_mass(model, Place::joint),
               arm_mass = place_mass(model, Place::arm);

  Trajectory run;
  run.output.resize(samples);
  if (options.keep_motion) {
    for (auto* motion : {&run.arm, &run.grasp, &run.joint}) motion->resize(samples);
  }
  const auto& x = grip->position_m;
  const auto& v = grip->velocity_m_per_s;
  const auto& a = grip->acceleration_m_per_s2;
  const auto joint_force = [&](std::size_t i) {
    const double force = grip_mass * a[i] + joint.force_N(i, x[i], v[i], a[i]);
    joint.remember(i, x[i], v[i]);
    if (i + 1 < samples) joint.advance(i, x[i], v[i], x[i + 1], v[i + 1]);
    return force;
  };
  if (model.base == BaseModel::msd) {
    for (std::size_t i = 0; i < samples; ++i) {
      run.output[i] = (model.msd.mass_kg + arm_mass) * a[i] + model.msd.b_Ns_per_m * v[i] + model.msd.k_N_per_m * x[i] +
                      arm.force_N(i, x[i], v[i], a[i]) + joint_force(i) - chain.force_offset_N;
      arm.remember(i, x[i], v[i]);
      if (i + 1 < samples) arm.advance(i, x[i], v[i], x[i + 1], v[i + 1]);
    }
    if (options.keep_motion) run.arm = run.joint = {x, v};
    return run;
  }
  // The arm behind the grasp moves on its own: its mass is driven through k1, b1 by the grip.
  const double k1 = model.arm.k1_N_per_m, b1 = model.arm.b1_Ns_per_m, mass = model.arm.mass_kg + arm_mass;
  const Eigen::MatrixXd dynamics{{0.0, 1.0},
                                 {-(k1 + model.arm.k2_N_per_m) / mass, -(b1 + model.arm.b2_Ns_per_m) / mass}};
  const Eigen::MatrixXd drive{{0.0}, {1 / mass}};
  const auto step = discretise(dynamics, drive, h);
  const Eigen::Matrix2d transition = step.transition;
  const Eigen::Vector2d at_start = step.at_start, at_end = step.at_end;
  Eigen::Vector2d state(options.initial.position_m, options.initial.velocity_m_per_s);
  double grasp_extra = 0, arm_extra = 0, acceleration = 0;
  for (std::size_t i = 0; i < samples; ++i) {
    run.output[i] =
        k1 * (x[i] - state[0]) + b1 * (v[i] - state[1]) + grasp_extra + joint_force(i) - chain.force_offset_N;
    if (options.keep_motion) {
      run.arm.x_m[i] = state[0];
      run.arm.v_m_per_s[i] = state[1];
      run.grasp.x_m[i] = x[i] - state[0];
      run.grasp.v_m_per_s[i] = v[i] - state[1];
    }
    if (i + 1 == samples) break;
    arm.remember(i, state[0], state[1]);
    grasp.remember(i, x[i] - state[0], v[i] - state[1]);
    const double now = k1 * x[i] + b1 * v[i], next = k1 * x[i + 1] + b1 * v[i + 1];
    const double extra = grasp_extra - arm_extra;
    const Eigen::Vector2d predicted = transition * state + at_start * (now + extra) + at_end * (next + extra);
    arm.advance(i, state[0], state[1], predicted[0], predicted[1]);
    grasp.advance(i, x[i] - state[0], v[i] - state[1], x[i + 1] - predicted[0], v[i + 1] - predicted[1]);
    arm_extra = arm.force_N(i + 1, predicted[0], predicted[1], acceleration);
    grasp_extra = grasp.force_N(i + 1, x[i + 1] - predicted[0], v[i + 1] - predicted[1], 0.0);
    const Eigen::Vector2d corrected =
        transition * state + at_start * (now + extra) + at_end * (next + grasp_extra - arm_extra);
    acceleration = (corrected[1] - state[1]) / h;
    state = corrected;
    arm_extra = arm.force_N(i + 1, state[0], state[1], acceleration);
    grasp_extra = grasp.force_N(i + 1, x[i + 1] - state[0], v[i + 1] - state[1], 0.0);
    if (!(std::abs(state[0]) < 1e6)) {
      run.finite = false;
      return run;
    }
  }
  if (options.keep_motion) run.joint = {x, v};
  return run;
}

std::vector<double> force_without_signal_effects(const AxisModel& model, std::span<const double> force_N,
                                                 double sample_time_s) {
  SignalChain chain(model);
  chain.actuator_delay_s += chain.sensor_delay_s;
  chain.actuator_lags_s.insert(chain.actuator_lags_s.end(), chain.sensor_lags_s.begin(), chain.sensor_lags_s.end());
  return actuated(force_N, chain, sample_time_s);
}

Trajectory recorded_motion(const AxisModel& model, const GripMotion& grip, std::span<const double> force_N,
                           const SimulationOptions& options) {
  Trajectory run;
  run.joint = {grip.position_m, grip.velocity_m_per_s};
  run.arm = run.joint;
  if (model.base == BaseModel::msd) return run;
  const double mass = place_mass(model, Place::grasp) + place_mass(model, Place::joint);
  const double k1 = model.arm.k1_N_per_m, b1 = std::max(model.arm.b1_Ns_per_m, kSmallestDamping);
  const auto through = [&](std::size_t i) { return force_N[i] - mass * grip.acceleration_m_per_s2[i]; };
  const auto decay = discretise_decay(k1 / b1, 1 / b1, options.sample_time_s);
  run.grasp.resize(force_N.size());
  double extension = 0;
  for (std::size_t i = 0; i < force_N.size(); ++i) {
    const double rate = (through(i) - k1 * extension) / b1;
    run.grasp.x_m[i] = extension;
    run.grasp.v_m_per_s[i] = rate;
    run.arm.x_m[i] -= extension;
    run.arm.v_m_per_s[i] -= rate;
    if (i + 1 < force_N.size())
      extension = decay.transition * extension + decay.at_start * through(i) + decay.at_end * through(i + 1);
  }
  return run;
}

std::vector<double> response_to_force(const AxisModel& model, Place place, std::span<const double> force,
                                      DrivenBy driven_by, const SimulationOptions& options) {
  const std::size_t samples = force.size();
  const double h = options.sample_time_s;
  std::vector<double> response(samples, 0.0);
  const bool at_grip = place == Place::joint;
  if (driven_by == DrivenBy::position) {
    if (at_grip || model.base == BaseModel::msd) return {force.begin(), force.end()};
    const double k1 = model.arm.k1_N_per_m, b1 = model.arm.b1_Ns_per_m,
                 mass = model.arm.mass_kg + place_mass(model, Place::arm);
    const Eigen::MatrixXd a{{0.0, 1.0}, {-(k1 + model.arm.k2_N_per_m) / mass, -(b1 + model.arm.b2_Ns_per_m) / mass}};
    const auto step = discretise(a, Eigen::MatrixXd{{0.0}, {1 / mass}}, h);
    const double sign = place == Place::arm ? -1.0 : 1.0;
    Eigen::Vector2d state(0, 0);
    for (std::size_t i = 0; i < samples; ++i) {
      response[i] = -k1 * state[0] - b1 * state[1] + (place == Place::grasp ? force[i] : 0.0);
      if (i + 1 < samples)
        state = (step.transition * state + sign * (step.at_start * force[i] + step.at_end * force[i + 1])).eval();
    }
    return response;
  }
  const double grip_mass = place_mass(model, Place::grasp) + place_mass(model, Place::joint);
  const ForceDrivenPlant plant(model, grip_mass, place_mass(model, Place::arm), h);
  const int input = place == Place::arm ? 2 : place == Place::grasp ? 1 : 0;
  const double sign = input == 0 ? -1.0 : 1.0;
  ForceDrivenPlant::State x = ForceDrivenPlant::State::Zero();
  for (std::size_t i = 0; i < samples; ++i) {
    response[i] = plant.grip_position(x);
    if (i + 1 == samples) break;
    ForceDrivenPlant::Input u0 = ForceDrivenPlant::Input::Zero(), u1 = u0;
    u0[input] = sign * force[i];
    u1[input] = sign * force[i + 1];
    x = plant.step(x, u0, u1);
  }
  return response;
}

std::vector<double> force_along(const AxisModel& model, const models::Effect& effect, const Trajectory& motion,
                                const SimulationOptions& options) {
  const auto& at = motion.at(effect.place());
  const std::size_t samples = at.x_m.size();
  const double h = options.sample_time_s;
  PlaceEffects acting(effect, model.port_base(effect.place()), h, samples, options.start_time_s);
  std::vector<double> force(samples);
  for (std::size_t i = 0; i < samples; ++i) {
    const double a = i == 0 ? 0.0 : (at.v_m_per_s[i] - at.v_m_per_s[i - 1]) / h;
    force[i] = acting.force_N(i, at.x_m[i], at.v_m_per_s[i], a);
    acting.remember(i, at.x_m[i], at.v_m_per_s[i]);
    if (i + 1 < samples) acting.advance(i, at.x_m[i], at.v_m_per_s[i], at.x_m[i + 1], at.v_m_per_s[i + 1]);
  }
  return force;
}

std::vector<double> first_order_response(const AxisModel& model, const Trajectory& motion, const models::Effect& effect,
                                         DrivenBy driven_by, const SimulationOptions& options) {
  auto force = force_along(model, effect, motion, options);
  const auto& v = motion.at(effect.place()).v_m_per_s;
  const double mass = effect.added_mass_kg(0.0);
  for (std::size_t i = 1; i < force.size(); ++i) force[i] += mass * ((v[i] - v[i - 1]) / options.sample_time_s);
  return response_to_force(model, effect.place(), force, driven_by, options);
}

}  // namespace handloop::identify
