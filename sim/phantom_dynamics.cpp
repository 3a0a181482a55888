#include "sim/phantom_dynamics.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/step_choice.h"

namespace handloop::sim {
namespace {

using Eigen::Vector3d;
using models::Axis;

/// What a stage adds to the step's beginning: 1 to 3 lead to the next stage, 4 to the end.
template <typename Rates>
auto runge_kutta_change(int stage, double h, const Rates& rate) {
  switch (stage) {
    case 1:
      return 0.5 * h * rate(0);
    case 2:
      return 0.5 * h * rate(1);
    case 3:
      return h * rate(2);
    default:
      return h / 6 * (rate(0) + 2 * rate(1) + 2 * rate(2) + rate(3));
  }
}

}  // namespace

PhantomDynamics::PhantomDynamics(const models::Scenario& scenario, bool with_visuals)
    : sample_time_s_(scenario.loop.sample_time_s),
      substeps_(choose_substeps(scenario)),
      step_s_(sample_time_s_ / substeps_),
      scene_(load_phantom(scenario.device, with_visuals)),
      data_(make_data(scene_.model.get())),
      hand_(scenario),
      actuator_(scenario, step_s_),
      pose_(scenario.device.pose_rad[0], scenario.device.pose_rad[1], scenario.device.pose_rad[2]),
      tip_at_pose_(tip_state(scene_, pose_, Vector3d::Zero()).position_m) {
  for (const Axis axis : models::kAxes) arms_.emplace_back(scenario.arm, axis, effects_of(scenario, axis), step_s_);
  const auto size = static_cast<std::size_t>(scene_.model->nv);
  start_q_.resize(size);
  start_v_.resize(size);
  for (auto& v : stage_v_) v.resize(size);
  for (auto& a : stage_a_) a.resize(size);
  set_up_structure(scenario.device);
  reset();
}

/// A two-mass mode in each capstan: the rotor on a spring against the link, of the given frequency where both are free.
void PhantomDynamics::set_up_structure(const models::DeviceSettings& device) {
  elastic_ = device.structural_frequency_Hz > 0;
  spring_Nm_per_rad_.setZero();
  damping_Nms_per_rad_.setZero();
  if (!elastic_) return;
  const double rate = 2 * std::numbers::pi * device.structural_frequency_Hz;
  const mjModel* model = scene_.model.get();
  Eigen::MatrixXd mass(model->nv, model->nv);
  place(pose_, Vector3d::Zero());
  mj_fwdPosition(model, data_.get());
  mj_fullM(model, mass.data(), data_->qM);
  for (int i = 0; i < 3; ++i) {
    const double link = mass(scene_.motor_dof[i], scene_.motor_dof[i]), rotor = scene_.rotor_kg_m2[i];
    const double reduced = link * rotor / (link + rotor);
    spring_Nm_per_rad_[i] = reduced * rate * rate;
    damping_Nms_per_rad_[i] = 2 * device.structural_damping_ratio * rate * reduced;
  }
}

void PhantomDynamics::place(const Vector3d& q_rad, const Vector3d& rate_rad_per_s) {
  const auto put = [&](double* to, const Vector3d& value) {
    for (int i = 0; i < 3; ++i) to[scene_.motor_dof[i]] = value[i];
    to[scene_.elbow_dof] = value[2] - value[1];
    to[scene_.coupler_dof] = value[1] - value[2];
  };
  mj_resetData(scene_.model.get(), data_.get());
  put(data_->qpos, q_rad);
  put(data_->qvel, rate_rad_per_s);
  rotor_rad_ = q_rad;
  rotor_rad_per_s_ = rate_rad_per_s;
}

void PhantomDynamics::place_arm(Axis axis, double position_m, double velocity_m_per_s) {
  arms_[static_cast<std::size_t>(axis)].place(position_m, velocity_m_per_s);
}

Vector3d PhantomDynamics::holding_torque_Nm() {
  const mjModel* model = scene_.model.get();
  mj_fwdPosition(model, data_.get());
  mj_fwdVelocity(model, data_.get());
  const double* weight = data_->qfrc_bias;
  const double loop = weight[scene_.elbow_dof] - weight[scene_.coupler_dof];  // elbow = q3 - q2, coupler = q2 - q3
  return {weight[scene_.motor_dof[0]], weight[scene_.motor_dof[1]] - loop, weight[scene_.motor_dof[2]] + loop};
}

void PhantomDynamics::reset() {
  place(pose_, Vector3d::Zero());
  for (auto& arm : arms_) arm.reset();
  hand_.reset();
  actuator_.reset();
  pull_ = {};
  torque_Nm_.setZero();
}

TipState PhantomDynamics::tip() const {
  return tip_state(scene_, data_->qpos, data_->qvel);
}

double PhantomDynamics::motor_side_rad(std::size_t motor) const {
  return elastic_ ? rotor_rad_[static_cast<Eigen::Index>(motor)] : data_->qpos[scene_.motor_dof[motor]];
}

double PhantomDynamics::motor_side_rad_per_s(std::size_t motor) const {
  return elastic_ ? rotor_rad_per_s_[static_cast<Eigen::Index>(motor)] : data_->qvel[scene_.motor_dof[motor]];
}

double PhantomDynamics::loop_gap_m() const {
  const double* q = data_->qpos;
  const double forearm = q[scene_.motor_dof[1]] + q[scene_.elbow_dof],
               coupler = q[scene_.motor_dof[2]] + q[scene_.coupler_dof];
  const Vector3d gap(scene_.upper_link_m * (std::cos(coupler) - std::cos(q[scene_.motor_dof[1]])) +
                         scene_.crank_m * (std::sin(q[scene_.motor_dof[2]]) - std::sin(forearm)),
                     0,
                     scene_.upper_link_m * (std::sin(coupler) - std::sin(q[scene_.motor_dof[1]])) -
                         scene_.crank_m * (std::cos(q[scene_.motor_dof[2]]) - std::cos(forearm)));
  return gap.norm();
}

AxisMotion PhantomDynamics::motion_of(Axis axis, double t_s, const TipState& tip, const HandMotion::Rest& rest,
                                      double muscle_N) const {
  const auto index = static_cast<std::size_t>(axis);
  const int row = models::device_row(axis);
  AxisMotion motion;
  motion.t_s = t_s;
  motion.grip_m = tip.position_m[row] - tip_at_pose_[row];
  motion.grip_m_per_s = tip.velocity_m_per_s[row];
  motion.rest_m = rest.position_m[index];
  motion.rest_m_per_s = rest.velocity_m_per_s[index];
  motion.muscle_N = axis == hand_.axis() ? muscle_N : 0.0;
  return motion;
}

PhantomDynamics::Reaction PhantomDynamics::reaction(double t_s, const TipState& tip) const {
  Reaction sum;
  const auto rest = hand_.rest(t_s);
  for (const Axis axis : models::kAxes) {
    const auto part = arm(axis).reaction(motion_of(axis, t_s, tip, rest, hand_.muscle_N(1.0)));
    const int row = models::device_row(axis);
    sum.force_N[row] = part.force_N;
    sum.inertia_kg[row] = part.inertia_kg;
    sum.grasp_N[row] = part.grasp_N;
  }
  sum.force_N += pull_reaction_N(tip);
  return sum;
}

Vector3d PhantomDynamics::tip_acceleration(const TipState& tip, const Reaction& reaction) {
  return solve(tip, reaction.force_N, reaction.inertia_kg, link_torques(0, tip, actuator_.added_at_end_N()));
}

double PhantomDynamics::energy_J(double t_s) {
  const mjModel* model = scene_.model.get();
  mj_fwdPosition(model, data_.get());
  Eigen::VectorXd momentum(model->nv);
  mj_mulM(model, data_.get(), momentum.data(), data_->qvel);
  double energy = 0.5 * momentum.dot(Eigen::Map<const Eigen::VectorXd>(data_->qvel, model->nv));
  const TipState now = tip();
  const auto rest = hand_.rest(t_s);
  for (const Axis axis : models::kAxes) energy += arm(axis).energy_J(motion_of(axis, t_s, now, rest, 0.0));
  return energy;
}

void PhantomDynamics::advance(std::uint64_t sample, const Vector3d& torque_Nm) {
  torque_Nm_ = torque_Nm;
  const auto number = static_cast<double>(sample);
  hand_.next_sample(number * sample_time_s_, (number + 1) * sample_time_s_);
  for (int i = 0; i < substeps_; ++i) {
    const double share = static_cast<double>(i) / substeps_;
    step((number + share) * sample_time_s_, share);
  }
}

void PhantomDynamics::step(double t_s, double share) {
  const double half = 0.5 * step_s_, part = 1.0 / substeps_;
  actuator_.begin_step(t_s, tip(), torque_Nm_);
  std::copy_n(data_->qpos, start_q_.size(), start_q_.begin());
  std::copy_n(data_->qvel, start_v_.size(), start_v_.begin());
  rotor_start_rad_ = rotor_rad_;
  rotor_start_rate_ = rotor_rad_per_s_;
  evaluate(0, t_s, share);
  advance_to(1);
  evaluate(1, t_s + half, share + 0.5 * part);
  advance_to(2);
  evaluate(2, t_s + half, share + 0.5 * part);
  advance_to(3);
  evaluate(3, t_s + step_s_, share + part);
  advance_to(4);
}

void PhantomDynamics::evaluate(int stage, double t_s, double share_of_sample) {
  const TipState now = tip();
  const auto rest = hand_.rest(t_s);
  const double muscle = hand_.muscle_N(share_of_sample);
  Vector3d force, inertia;
  for (const Axis axis : models::kAxes) {
    auto& arm = arms_[static_cast<std::size_t>(axis)];
    const auto motion = motion_of(axis, t_s, now, rest, muscle);
    if (stage == 0) arm.remember(motion);
    const auto part = arm.evaluate(stage, motion);
    force[models::device_row(axis)] = part.force_N;
    inertia[models::device_row(axis)] = part.inertia_kg;
  }
  force += pull_reaction_N(now);
  solve(now, force, inertia, link_torques(stage, now, actuator_.added_N(stage)));
  std::copy_n(data_->qvel, stage_v_[stage].size(), stage_v_[stage].begin());
  std::copy_n(data_->qacc, stage_a_[stage].size(), stage_a_[stage].begin());
}

void PhantomDynamics::advance_to(int stage) {
  for (std::size_t i = 0; i < start_q_.size(); ++i) {
    data_->qpos[i] = start_q_[i] + runge_kutta_change(stage, step_s_, [&](int s) { return stage_v_[s][i]; });
    data_->qvel[i] = start_v_[i] + runge_kutta_change(stage, step_s_, [&](int s) { return stage_a_[s][i]; });
  }
  if (elastic_) {
    for (int i = 0; i < 3; ++i) {
      rotor_rad_[i] =
          rotor_start_rad_[i] + runge_kutta_change(stage, step_s_, [&](int s) { return rotor_rate_[s][i]; });
      rotor_rad_per_s_[i] =
          rotor_start_rate_[i] + runge_kutta_change(stage, step_s_, [&](int s) { return rotor_acceleration_[s][i]; });
    }
  }
  for (auto& arm : arms_) arm.advance_to(stage);
}

/// Torque that reaches the links, and with an elastic structure the rates of the rotors at this stage.
Vector3d PhantomDynamics::link_torques(int stage, const TipState& tip, const Vector3d& actuator_N) {
  const Vector3d torque = torque_Nm_ + tip.jacobian.transpose() * actuator_N;
  if (!elastic_) return torque;
  Vector3d on_link;
  for (int i = 0; i < 3; ++i) {
    const int dof = scene_.motor_dof[i];
    on_link[i] = spring_Nm_per_rad_[i] * (rotor_rad_[i] - data_->qpos[dof]) +
                 damping_Nms_per_rad_[i] * (rotor_rad_per_s_[i] - data_->qvel[dof]);
    rotor_rate_[stage][i] = rotor_rad_per_s_[i];
    rotor_acceleration_[stage][i] = (torque[i] - on_link[i]) / scene_.rotor_kg_m2[i];
  }
  return on_link;
}

Vector3d PhantomDynamics::pull_reaction_N(const TipState& tip) const {
  if (!(pull_.stiffness_N_per_m > 0)) return Vector3d::Zero();
  const Vector3d anchor(pull_.anchor_m[0], pull_.anchor_m[1], pull_.anchor_m[2]);
  Vector3d force = pull_.stiffness_N_per_m * (tip.position_m - anchor);
  if (const double size = force.norm(); size > pull_.limit_N) force *= pull_.limit_N / size;
  return force + pull_.damping_Ns_per_m * tip.velocity_m_per_s;
}

void PhantomDynamics::push_tip(const TipState& tip, const Vector3d& force_N) {
  const Vector3d torque = tip.jacobian.transpose() * force_N;
  data_->qfrc_applied[scene_.motor_dof[0]] = torque[0];
  data_->qfrc_applied[scene_.motor_dof[1]] = torque[1] + torque[2];
  data_->qfrc_applied[scene_.elbow_dof] = torque[2];
}

/// Masses that move with the tip along one axis each: J^T diag(m) J added to the mass matrix MuJoCo has just found.
void PhantomDynamics::add_tip_inertia(const TipState& tip, const Vector3d& mass_kg) {
  if (mass_kg.isZero(0.0)) return;
  // columns by turret, upper link (which carries the forearm along) and elbow: a chain of ancestors
  Eigen::Matrix3d columns;
  columns << tip.jacobian.col(0), tip.jacobian.col(1) + tip.jacobian.col(2), tip.jacobian.col(2);
  const Eigen::Matrix3d added = columns.transpose() * mass_kg.asDiagonal() * columns;
  const std::array<int, 3> dofs{scene_.motor_dof[0], scene_.motor_dof[1], scene_.elbow_dof};
  const mjModel* model = scene_.model.get();
  for (int i = 0; i < 3; ++i) {
    int address = model->dof_Madr[dofs[i]];
    for (int j = dofs[i]; j >= 0; j = model->dof_parentid[j], ++address) {
      for (int k = 0; k <= i; ++k) {
        if (dofs[k] == j) data_->qM[address] += added(i, k);
      }
    }
  }
  mj_factorM(model, data_.get());
}

/// Accelerations at the present positions and velocities. Returns that of the tip.
Vector3d PhantomDynamics::solve(const TipState& tip, const Vector3d& reaction_N, const Vector3d& inertia_kg,
                                const Vector3d& link_torque_Nm) {
  const mjModel* model = scene_.model.get();
  mjData* d = data_.get();
  push_tip(tip, -reaction_N - inertia_kg.cwiseProduct(tip.bias_m_per_s2));
  for (int i = 0; i < 3; ++i) d->ctrl[i] = link_torque_Nm[i];
  mj_fwdPosition(model, d);
  add_tip_inertia(tip, inertia_kg);
  mj_fwdVelocity(model, d);
  mj_fwdActuation(model, d);
  mj_fwdAcceleration(model, d);
  mj_fwdConstraint(model, d);
  const double forearm = d->qacc[scene_.motor_dof[1]] + d->qacc[scene_.elbow_dof];
  return tip.bias_m_per_s2 +
         tip.jacobian * Vector3d(d->qacc[scene_.motor_dof[0]], d->qacc[scene_.motor_dof[1]], forearm);
}

}  // namespace handloop::sim
