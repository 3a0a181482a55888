#include "sim/phantom_plant.h"

#include <mujoco/mujoco.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "models/errors.h"
#include "sim/arm_axis.h"
#include "sim/arm_picture.h"
#include "sim/electronics.h"
#include "sim/hand_motion.h"
#include "sim/phantom_scene.h"
#include "sim/signal_path.h"

namespace handloop::sim {
namespace {

using Eigen::Vector3d;
using models::Axis;
using models::Place;

/// Explicit fourth-order steps follow rates up to this over the step to a fraction of a percent.
constexpr double kRateTimesStep = 0.7;
constexpr int kMostSubsteps = 200;
/// Apparent mass of the bare device at its tip, at least (set A and B, any axis).
constexpr double kLeastTipMass_kg = 0.028;

std::vector<models::EffectPtr> effects_of(const models::Scenario& scenario, Axis axis) {
  std::vector<models::EffectPtr> effects;
  for (const auto& [where, effect] : scenario.arm.effects) {
    if (where == axis) effects.push_back(effect);
  }
  return effects;
}

int choose_substeps(const models::Scenario& scenario) {
  const double sample = scenario.loop.sample_time_s;
  const auto require_positive = [](const char* key, double value) {
    if (!(value > 0) || !std::isfinite(value)) {
      throw InputError(std::string(key) + " = " + std::to_string(value) + " is not possible: it must be above zero");
    }
  };
  require_positive("loop.sample_time_s", sample);
  require_positive("run.physics_step_s", scenario.run.physics_step_s);
  if (scenario.loop.delay_samples < 0) throw InputError("loop.delay_samples must be zero or more");
  double rate = 2 * 3.141592653589793 * scenario.device.structural_frequency_Hz;
  for (const Axis axis : models::kAxes) {
    const auto& arm = scenario.arm.axes[static_cast<std::size_t>(axis)];
    if (scenario.arm.attached) models::require_valid(arm);
    const double stylus = kLeastTipMass_kg + scenario.device.stylus_mass_kg;
    const auto held = scenario.arm.attached ? arm : models::ArmParameters{1.0, 0.0, 0.0, 0.0, 0.0};
    rate = std::max(rate, fastest_rate(held, effects_of(scenario, axis), stylus));
  }
  const double longest = std::min(scenario.run.physics_step_s, kRateTimesStep / rate);
  return std::clamp(static_cast<int>(std::ceil(sample / longest - 1e-9)), 1, kMostSubsteps);
}

}  // namespace

struct PhantomPlant::Impl {
  models::Scenario scenario;
  PhantomScene scene;
  DataPtr data;
  Electronics electronics;
  HandMotion hand;
  PlantDescription description;
  int substeps;
  double step_s;
  std::vector<ArmAxis> arms;                   // by axis
  std::array<SignalPath, 3> actuator, sensor;  // by axis
  std::array<DelayLine, 3> sensor_past;
  std::array<std::vector<double>, 3> actuator_past;  // commanded axis force of each half step, a ring
  std::array<double, 3> actuator_start{}, actuator_middle{},
      actuator_end{};  // force the effects add, at the stage times
  std::vector<double> start_q, start_v;
  std::array<std::vector<double>, 4> stage_v, stage_a;
  Vector3d pose = Vector3d::Zero(), tip_at_pose = Vector3d::Zero();
  bool needs_acceleration = false, elastic = false;
  std::array<double, 3> spring_Nm_per_rad{}, spring_damping{};
  std::array<std::array<double, 3>, 4> rotor_rate{}, rotor_acceleration{};
  std::array<double, 3> rotor_rad{}, rotor_rad_per_s{}, rotor_start_rad{}, rotor_start_rate{};

  std::vector<std::array<double, kMotors>> waiting_currents;  // delay_samples of them, a ring
  std::uint64_t sample = 0;
  std::array<double, kMotors> current_A{};
  std::uint64_t half_steps = 0;

  PlantTruth seen;                         // as of the present sample
  std::array<double, 3> sensed_force_N{};  // device frame
  std::array<double, kMotors> encoder_shift_rad{};

  Impl(const models::Scenario& wanted, const PlantOptions& options)
      : scenario(wanted),
        scene(load_phantom(wanted.device, options.with_visuals)),
        data(make_data(scene.model.get())),
        electronics(wanted),
        hand(wanted),
        description(electronics.describe()),
        substeps(choose_substeps(wanted)),
        step_s(wanted.loop.sample_time_s / substeps) {
    description.physics_step_s = step_s;
    pose = Vector3d(scenario.device.pose_rad[0], scenario.device.pose_rad[1], scenario.device.pose_rad[2]);
    for (std::size_t i = 0; i < kMotors; ++i) description.encoder_zero_rad[i] = pose[i];
    tip_at_pose = tip_state(scene, pose, Vector3d::Zero()).position_m;
    needs_acceleration = scenario.arm.force_sensed_at == models::ForceSensedAt::flange;
    for (const Axis axis : models::kAxes) add_axis(axis);
    const auto size = static_cast<std::size_t>(scene.model->nv);
    start_q.resize(size);
    start_v.resize(size);
    for (auto& v : stage_v) v.resize(size);
    for (auto& a : stage_a) a.resize(size);
    waiting_currents.resize(static_cast<std::size_t>(scenario.loop.delay_samples));
    set_up_structure();
    reset();
  }

  void add_axis(Axis axis) {
    const auto index = static_cast<std::size_t>(axis);
    const auto effects = effects_of(scenario, axis);
    arms.emplace_back(scenario.arm.axes[index], effects, step_s, scenario.arm.attached);
    for (const auto& effect : effects) {
      if (effect->place() != Place::arm && effect->added_mass_kg(1.0) != 0) needs_acceleration = true;
    }
    actuator[index] = SignalPath(effects, Place::actuator, 0.5 * step_s);
    sensor[index] = SignalPath(effects, Place::sensor, scenario.loop.sample_time_s);
    sensor_past[index] = DelayLine(std::max(sensor[index].delay_s(), 1e-9), scenario.loop.sample_time_s);
    actuator_past[index].resize(static_cast<std::size_t>(actuator[index].delay_s() / (0.5 * step_s)) + 2);
  }

  /// A two-mass mode in each capstan: the rotor on a spring against the link, of the given frequency with both free.
  void set_up_structure() {
    elastic = scenario.device.structural_frequency_Hz > 0;
    if (!elastic) return;
    const double rate = 2 * 3.141592653589793 * scenario.device.structural_frequency_Hz;
    std::vector<double> mass(scene.model->nv * scene.model->nv);
    place_at_pose();
    mj_fwdPosition(scene.model.get(), data.get());
    mj_fullM(scene.model.get(), mass.data(), data->qM);
    for (std::size_t i = 0; i < 3; ++i) {
      const int dof = scene.motor_dof[i];
      const double link = mass[static_cast<std::size_t>(dof * scene.model->nv + dof)], rotor = scene.rotor_kg_m2[i];
      const double reduced = link * rotor / (link + rotor);
      spring_Nm_per_rad[i] = reduced * rate * rate;
      spring_damping[i] = 2 * scenario.device.structural_damping_ratio * rate * reduced;
    }
  }

  void place_at_pose() noexcept {
    mj_resetData(scene.model.get(), data.get());
    for (std::size_t i = 0; i < 3; ++i) data->qpos[scene.motor_dof[i]] = pose[i];
    data->qpos[scene.elbow_dof] = pose[2] - pose[1];
    data->qpos[scene.coupler_dof] = pose[1] - pose[2];
  }

  void reset() noexcept {
    place_at_pose();
    for (auto& arm : arms) arm.reset();
    for (std::size_t i = 0; i < 3; ++i) {
      actuator[i].reset();
      sensor[i].reset();
      sensor_past[i].reset();
      std::ranges::fill(actuator_past[i], 0.0);
      rotor_rad[i] = pose[i];
      rotor_rad_per_s[i] = 0.0;
    }
    actuator_start = actuator_middle = actuator_end = {};
    hand.reset();
    for (auto& waiting : waiting_currents) waiting = {};
    sample = half_steps = 0;
    current_A = {};
    seen = {};
    observe();
  }

  // ---- one step -------------------------------------------------------------------------------------------------

  AxisMotion motion_of(Axis axis, double t_s, const TipState& tip, const HandMotion::Rest& rest,
                       double muscle_N) const {
    const auto index = static_cast<std::size_t>(axis);
    const int row = models::device_row(axis);
    AxisMotion motion;
    motion.t_s = t_s;
    motion.grip_m = tip.position_m[row] - tip_at_pose[row];
    motion.grip_m_per_s = tip.velocity_m_per_s[row];
    motion.rest_m = rest.position_m[index];
    motion.rest_m_per_s = rest.velocity_m_per_s[index];
    motion.muscle_N = axis == hand.axis() ? muscle_N : 0.0;
    return motion;
  }

  void push_tip(const TipState& tip, const Vector3d& force_N) noexcept {
    const Vector3d torque = tip.jacobian.transpose() * force_N;
    data->qfrc_applied[scene.motor_dof[0]] = torque[0];
    data->qfrc_applied[scene.motor_dof[1]] = torque[1] + torque[2];
    data->qfrc_applied[scene.elbow_dof] = torque[2];
  }

  /// Masses that move with the tip along one axis each: J^T diag(m) J added to the mass matrix MuJoCo has just found.
  void add_tip_inertia(const TipState& tip, const Vector3d& mass_kg) noexcept {
    if (mass_kg.isZero(0.0)) return;
    // columns by turret, upper link (which carries the forearm along) and elbow: a chain of ancestors
    Eigen::Matrix3d columns;
    columns.col(0) = tip.jacobian.col(0);
    columns.col(1) = tip.jacobian.col(1) + tip.jacobian.col(2);
    columns.col(2) = tip.jacobian.col(2);
    const Eigen::Matrix3d added = columns.transpose() * mass_kg.asDiagonal() * columns;
    const std::array<int, 3> dofs{scene.motor_dof[0], scene.motor_dof[1], scene.elbow_dof};
    const mjModel* model = scene.model.get();
    for (int i = 0; i < 3; ++i) {
      int address = model->dof_Madr[dofs[i]];
      for (int j = dofs[i]; j >= 0; j = model->dof_parentid[j], ++address) {
        for (int k = 0; k <= i; ++k) {
          if (dofs[k] == j) data->qM[address] += added(i, k);
        }
      }
    }
    mj_factorM(model, data.get());
  }

  /// Accelerations at the present qpos and qvel. Returns that of the tip, device frame.
  Vector3d solve(const TipState& tip, const Vector3d& reaction_N, const Vector3d& inertia_kg,
                 const std::array<double, 3>& link_torque_Nm) noexcept {
    const mjModel* model = scene.model.get();
    mjData* d = data.get();
    push_tip(tip, -reaction_N - inertia_kg.cwiseProduct(tip.bias_m_per_s2));
    for (int i = 0; i < 3; ++i) d->ctrl[i] = link_torque_Nm[i];
    mj_fwdPosition(model, d);
    add_tip_inertia(tip, inertia_kg);
    mj_fwdVelocity(model, d);
    mj_fwdActuation(model, d);
    mj_fwdAcceleration(model, d);
    mj_fwdConstraint(model, d);
    const int q2 = scene.motor_dof[1];
    return tip.bias_m_per_s2 +
           tip.jacobian * Vector3d(d->qacc[scene.motor_dof[0]], d->qacc[q2], d->qacc[q2] + d->qacc[scene.elbow_dof]);
  }

  /// Torque that reaches the links, and with an elastic structure the rates of the rotors at this stage.
  std::array<double, 3> link_torques(int stage, const TipState& tip, const std::array<double, 3>& actuator_N) noexcept {
    Vector3d torque;
    for (std::size_t i = 0; i < 3; ++i) torque[i] = electronics.joint_torque_Nm(i, current_A[i]);
    Vector3d extra = Vector3d::Zero();
    for (const Axis axis : models::kAxes) extra[models::device_row(axis)] = actuator_N[static_cast<std::size_t>(axis)];
    torque += tip.jacobian.transpose() * extra;
    std::array<double, 3> on_link{torque[0], torque[1], torque[2]};
    if (!elastic) return on_link;
    for (std::size_t i = 0; i < 3; ++i) {
      const int dof = scene.motor_dof[i];
      const double spring = spring_Nm_per_rad[i] * (rotor_rad[i] - data->qpos[dof]) +
                            spring_damping[i] * (rotor_rad_per_s[i] - data->qvel[dof]);
      rotor_rate[stage][i] = rotor_rad_per_s[i];
      rotor_acceleration[stage][i] = (torque[i] - spring) / scene.rotor_kg_m2[i];
      on_link[i] = spring;
    }
    return on_link;
  }

  void evaluate(int stage, double t_s, double share_of_sample) noexcept {
    const TipState tip = tip_state(scene, data->qpos, data->qvel);
    const auto rest = hand.rest(t_s);
    const double muscle = hand.muscle_N(share_of_sample);
    Vector3d reaction = Vector3d::Zero(), inertia = Vector3d::Zero();
    for (const Axis axis : models::kAxes) {
      auto& arm = arms[static_cast<std::size_t>(axis)];
      const auto motion = motion_of(axis, t_s, tip, rest, muscle);
      if (stage == 0) arm.remember(motion);
      const auto result = arm.evaluate(stage, motion);
      reaction[models::device_row(axis)] = result.force_N;
      inertia[models::device_row(axis)] = result.inertia_kg;
    }
    const auto& actuator_N = stage == 0 ? actuator_start : stage == 3 ? actuator_end : actuator_middle;
    solve(tip, reaction, inertia, link_torques(stage, tip, actuator_N));
    const int size = scene.model->nv;
    std::copy_n(data->qvel, size, stage_v[stage].begin());
    std::copy_n(data->qacc, size, stage_a[stage].begin());
  }

  /// States of stage 1, 2, 3 or, with 4, of the step's end.
  void advance_to(int stage) noexcept {
    const double h = step_s;
    for (std::size_t i = 0; i < start_q.size(); ++i) {
      const auto change = [&](const std::array<std::vector<double>, 4>& rates) {
        switch (stage) {
          case 1:
            return 0.5 * h * rates[0][i];
          case 2:
            return 0.5 * h * rates[1][i];
          case 3:
            return h * rates[2][i];
          default:
            return h / 6 * (rates[0][i] + 2 * rates[1][i] + 2 * rates[2][i] + rates[3][i]);
        }
      };
      data->qpos[i] = start_q[i] + change(stage_v);
      data->qvel[i] = start_v[i] + change(stage_a);
    }
    if (elastic) advance_rotors(stage);
    for (auto& arm : arms) arm.advance_to(stage);
  }

  void advance_rotors(int stage) noexcept {
    const double h = step_s;
    const auto change = [&](const std::array<std::array<double, 3>, 4>& rates, std::size_t i) {
      switch (stage) {
        case 1:
          return 0.5 * h * rates[0][i];
        case 2:
          return 0.5 * h * rates[1][i];
        case 3:
          return h * rates[2][i];
        default:
          return h / 6 * (rates[0][i] + 2 * rates[1][i] + 2 * rates[2][i] + rates[3][i]);
      }
    };
    for (std::size_t i = 0; i < 3; ++i) {
      rotor_rad[i] = rotor_start_rad[i] + change(rotor_rate, i);
      rotor_rad_per_s[i] = rotor_start_rate[i] + change(rotor_acceleration, i);
    }
  }

  /// Effects on the actuator's signal act on the commanded force along their axis: here is what they add to it.
  void drive_actuator_effects(double t_s) noexcept {
    const TipState tip = tip_state(scene, data->qpos, data->qvel);
    Vector3d commanded = Vector3d::Zero();
    bool known = false;
    for (const Axis axis : models::kAxes) {
      const auto i = static_cast<std::size_t>(axis);
      if (actuator[i].empty()) continue;
      if (!known) {
        Vector3d torque;
        for (std::size_t m = 0; m < 3; ++m) torque[m] = electronics.joint_torque_Nm(m, current_A[m]);
        commanded = tip.jacobian.transpose().partialPivLu().solve(torque);
        known = true;
      }
      const double now = commanded[models::device_row(axis)];
      auto& past = actuator_past[i];
      const double late = actuator[i].delay_s() / (0.5 * step_s);
      const auto whole = static_cast<std::uint64_t>(late);
      const double part = late - static_cast<double>(whole);
      const auto half = [&](std::uint64_t number) {  // mean of the delayed command over half step `number`
        past[number % past.size()] = now;
        const auto before = [&](std::uint64_t steps) {
          return steps > number ? 0.0 : past[(number - steps) % past.size()];
        };
        return (1 - part) * before(whole) + part * before(whole + 1);
      };
      const double first = half(half_steps), second = half(half_steps + 1);
      const double add = actuator[i].addition(t_s) - now;
      actuator_start[i] = actuator[i].output(first) + add;
      actuator[i].step(first, first);
      actuator_middle[i] = 0.5 * (actuator[i].output(first) + actuator[i].output(second)) + add;
      actuator[i].step(second, second);
      actuator_end[i] = actuator[i].output(second) + add;
    }
    half_steps += 2;
  }

  void step(int index) noexcept {
    const double t =
        (static_cast<double>(sample) + static_cast<double>(index) / substeps) * scenario.loop.sample_time_s;
    const double share = static_cast<double>(index) / substeps, part = 1.0 / substeps;
    drive_actuator_effects(t);
    std::copy_n(data->qpos, start_q.size(), start_q.begin());
    std::copy_n(data->qvel, start_v.size(), start_v.begin());
    rotor_start_rad = rotor_rad;
    rotor_start_rate = rotor_rad_per_s;
    evaluate(0, t, share);
    advance_to(1);
    evaluate(1, t + 0.5 * step_s, share + 0.5 * part);
    advance_to(2);
    evaluate(2, t + 0.5 * step_s, share + 0.5 * part);
    advance_to(3);
    evaluate(3, t + step_s, share + part);
    advance_to(4);
  }

  void advance(const PlantCommand& command) noexcept {
    if (seen.diverged) {
      ++sample;
      return;
    }
    const auto asked = electronics.currents_A(command);
    if (waiting_currents.empty()) {
      current_A = asked;
    } else {
      auto& slot = waiting_currents[sample % waiting_currents.size()];
      current_A = slot;
      slot = asked;
    }
    const double T = scenario.loop.sample_time_s;
    hand.next_sample(static_cast<double>(sample) * T, static_cast<double>(sample + 1) * T);
    for (int i = 0; i < substeps; ++i) step(i);
    ++sample;
    observe();
  }

  // ---- what is to be seen ---------------------------------------------------------------------------------------

  void observe() noexcept {
    const double t = static_cast<double>(sample) * scenario.loop.sample_time_s;
    const TipState tip = tip_state(scene, data->qpos, data->qvel);
    if (!tip.position_m.allFinite() || !tip.velocity_m_per_s.allFinite() || tip.velocity_m_per_s.norm() > 1e3) {
      seen.diverged = true;
      return;
    }
    const auto rest = hand.rest(t);
    const double muscle = hand.muscle_N(1.0);
    Vector3d reaction = Vector3d::Zero(), inertia = Vector3d::Zero();
    for (const Axis axis : models::kAxes) {
      const auto i = static_cast<std::size_t>(axis);
      const auto motion = motion_of(axis, t, tip, rest, muscle);
      const auto result = arms[i].reaction(motion);
      reaction[models::device_row(axis)] = result.force_N;
      inertia[models::device_row(axis)] = result.inertia_kg;
      seen.tip_m[i] = motion.grip_m;
      seen.tip_m_per_s[i] = motion.grip_m_per_s;
      seen.hand_force_N[i] = result.grasp_N;
      seen.arm_mass_m[i] = arms[i].position_m();
    }
    Vector3d sensed = reaction;
    if (needs_acceleration) {
      const Vector3d acceleration = solve(tip, reaction, inertia, link_torques(0, tip, actuator_end));
      sensed += inertia.cwiseProduct(acceleration);
      const Vector3d flange = sensed + scene.stylus_mass_kg * acceleration;
      for (const Axis axis : models::kAxes) {
        seen.flange_force_N[static_cast<std::size_t>(axis)] = flange[models::device_row(axis)];
      }
      if (scenario.arm.force_sensed_at == models::ForceSensedAt::flange) sensed = flange;
    }
    for (std::size_t row = 0; row < 3; ++row) sensed_force_N[row] = sensed[row];
    seen.t_s = t;
    seen.grip_force_N = scenario.arm.attached ? scenario.arm.grip_force_N : 0.0;
    for (std::size_t i = 0; i < 3; ++i) {
      const int dof = scene.motor_dof[i];
      seen.joint_rad[i] = elastic ? rotor_rad[i] : data->qpos[dof];
      seen.joint_rad_per_s[i] = elastic ? rotor_rad_per_s[i] : data->qvel[dof];
      seen.motor_current_A[i] = current_A[i];
    }
    const double open = data->qpos[scene.elbow_dof] - (data->qpos[scene.motor_dof[2]] - data->qpos[scene.motor_dof[1]]);
    seen.loop_gap_m = std::abs(open) * kCrank_m;
    sense_position(t, tip);
  }

  static constexpr double kCrank_m = 0.0325;

  /// Effects on the position signal shift what the encoders say by J^-1 of the shift along their axis.
  void sense_position(double t_s, const TipState& tip) noexcept {
    Vector3d shift = Vector3d::Zero();
    for (const Axis axis : models::kAxes) {
      const auto i = static_cast<std::size_t>(axis);
      if (sensor[i].empty()) continue;
      const DelayLine::Motion now{seen.tip_m[i], seen.tip_m_per_s[i]};
      const double before = sensor_last_[i];
      sensor_past[i].push(t_s, now);
      const double late = sensor[i].delay_s() > 0 ? sensor_past[i].at_delay(t_s, now).x_m : now.x_m;
      if (sample > 0) sensor[i].step(before, late);
      sensor_last_[i] = late;
      shift[models::device_row(axis)] = sensor[i].output(late) + sensor[i].addition(t_s) - now.x_m;
    }
    encoder_shift_rad = {};
    if (shift.isZero(0.0)) return;
    const Vector3d joint = tip.jacobian.partialPivLu().solve(shift);
    for (std::size_t i = 0; i < 3; ++i) encoder_shift_rad[i] = joint[i];
  }
  std::array<double, 3> sensor_last_{};

  PlantReading read() const noexcept {
    PlantReading reading;
    reading.sample = sample;
    for (std::size_t i = 0; i < kMotors; ++i) {
      reading.encoder_counts[i] = electronics.encoder_counts(i, seen.joint_rad[i] + encoder_shift_rad[i] - pose[i]);
    }
    reading.adc_codes = electronics.adc_codes(sample, sensed_force_N, seen.grip_force_N);
    return reading;
  }
};

PhantomPlant::PhantomPlant(const models::Scenario& scenario, const PlantOptions& options)
    : impl_(std::make_unique<Impl>(scenario, options)) {}
PhantomPlant::~PhantomPlant() = default;
PhantomPlant::PhantomPlant(PhantomPlant&&) noexcept = default;
PhantomPlant& PhantomPlant::operator=(PhantomPlant&&) noexcept = default;

const PlantDescription& PhantomPlant::description() const {
  return impl_->description;
}
PlantReading PhantomPlant::read() const noexcept {
  return impl_->read();
}
void PhantomPlant::advance(const PlantCommand& command) noexcept {
  impl_->advance(command);
}
void PhantomPlant::reset() noexcept {
  impl_->reset();
}
PlantTruth PhantomPlant::truth() const noexcept {
  return impl_->seen;
}
const mjModel* PhantomPlant::mujoco_model() const {
  return impl_->scene.model.get();
}

mjData* PhantomPlant::picture() {
  pose_picture(impl_->scene, impl_->tip_at_pose, impl_->seen, impl_->scenario.wall, impl_->data.get());
  return impl_->data.get();
}

}  // namespace handloop::sim
