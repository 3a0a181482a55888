#include "sim/phantom_scene.h"

#include <mujoco/mujoco.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string>

#include "models/errors.h"
#include "models/phantom.h"
#include "models/transducers.h"

namespace handloop::sim {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Where a counterweight for the gimbal would sit behind the shoulder: an assumption, no drawing was found.
constexpr double kCounterweightArm_m = 0.075;

int id(const mjModel* model, int type, const char* name) {
  const int found = mj_name2id(model, type, name);
  if (found < 0)
    throw InputError(std::string("phantom.xml: nothing is named '") + name + "', which the simulated Phantom needs");
  return found;
}

int dof(const mjModel* model, const char* joint) {
  return model->jnt_dofadr[id(model, mjOBJ_JOINT, joint)];
}

/// A link in the axes its body has in the scene: at pose zero x fore-aft, y lateral, z up.
models::PhantomBody body_of(const mjModel* model, int body) {
  models::PhantomBody rigid;
  rigid.mass_kg = model->body_mass[body];
  rigid.centre_of_mass_m = Eigen::Map<const Vector3d>(model->body_ipos + 3 * body);
  const double* q = model->body_iquat + 4 * body;
  const Matrix3d rotation = Eigen::Quaterniond(q[0], q[1], q[2], q[3]).toRotationMatrix();
  const Vector3d moments = Eigen::Map<const Vector3d>(model->body_inertia + 3 * body);
  rigid.inertia_kg_m2 = rotation * moments.asDiagonal() * rotation.transpose();
  return rigid;
}

/// From its own frame, whose axes are the columns of rotation, into the scene's axes.
models::PhantomBody turned(const models::PhantomBody& link, const Matrix3d& rotation) {
  return {link.mass_kg, rotation * link.centre_of_mass_m, rotation * link.inertia_kg_m2 * rotation.transpose()};
}

Matrix3d steiner(double mass_kg, const Vector3d& offset_m) {
  return mass_kg * (offset_m.squaredNorm() * Matrix3d::Identity() - offset_m * offset_m.transpose());
}

/// Two bodies moving as one.
models::PhantomBody joined(const models::PhantomBody& a, const models::PhantomBody& b) {
  models::PhantomBody sum;
  sum.mass_kg = a.mass_kg + b.mass_kg;
  sum.centre_of_mass_m = (a.mass_kg * a.centre_of_mass_m + b.mass_kg * b.centre_of_mass_m) / sum.mass_kg;
  sum.inertia_kg_m2 = a.inertia_kg_m2 + steiner(a.mass_kg, a.centre_of_mass_m - sum.centre_of_mass_m) +
                      b.inertia_kg_m2 + steiner(b.mass_kg, b.centre_of_mass_m - sum.centre_of_mass_m);
  return sum;
}

void set_body(mjModel* model, int body, const models::PhantomBody& rigid) {
  const Eigen::SelfAdjointEigenSolver<Matrix3d> principal(rigid.inertia_kg_m2);
  Matrix3d axes = principal.eigenvectors();
  if (axes.determinant() < 0) axes.col(0) *= -1;
  const Eigen::Quaterniond q(axes);
  model->body_sameframe[body] = 0;  // the compiler may have noted that inertia and body share a frame
  model->body_mass[body] = rigid.mass_kg;
  Eigen::Map<Vector3d>(model->body_ipos + 3 * body) = rigid.centre_of_mass_m;
  Eigen::Map<Vector3d>(model->body_inertia + 3 * body) = principal.eigenvalues();
  model->body_iquat[4 * body] = q.w();
  model->body_iquat[4 * body + 1] = q.x();
  model->body_iquat[4 * body + 2] = q.y();
  model->body_iquat[4 * body + 3] = q.z();
}

/// Set A: other masses and other lengths, so everything that hangs on l1, l2 and l3 moves.
void use_cad_set(mjModel* model) {
  using models::PhantomLink;
  const auto set = models::phantom_parameters(models::PhantomParameterSet::cad);
  // link frames {2}, {2'} are Rx(90 deg) at pose zero, {3}, {3'} are Rx(90 deg) Rz(-90 deg)
  Matrix3d standing, hanging;
  standing << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  hanging << 0, 1, 0, 0, 0, -1, -1, 0, 0;
  const auto set_link = [&](const char* name, PhantomLink link, const Matrix3d& rotation) {
    set_body(model, id(model, mjOBJ_BODY, name), turned(set.body(link), rotation));
  };
  set_link("turret", PhantomLink::base, Matrix3d::Identity());
  set_link("upper_link", PhantomLink::upper, standing);
  set_link("forearm", PhantomLink::forearm, standing);
  set_link("crank", PhantomLink::crank, hanging);
  set_link("coupler", PhantomLink::coupler, hanging);
  model->body_pos[3 * id(model, mjOBJ_BODY, "forearm")] = set.l1_m;
  model->body_pos[3 * id(model, mjOBJ_BODY, "coupler") + 2] = -set.l3_m;
  model->body_pos[3 * id(model, mjOBJ_BODY, "gimbal_outer") + 2] = -set.l2_m;
  model->site_pos[3 * id(model, mjOBJ_SITE, "tip") + 2] = -set.l2_m;
  mjtNum* anchors = model->eq_data + mjNEQDATA * id(model, mjOBJ_EQUALITY, "parallelogram");
  std::fill(anchors, anchors + 6, 0.0);
  anchors[0] = set.l1_m;   // on the coupler
  anchors[5] = -set.l3_m;  // on the forearm
  for (const char* joint : {"q2", "q3"}) model->dof_armature[dof(model, joint)] = 0;
  model->opt.gravity[2] = -set.gravity_m_per_s2;
}

void set_stylus_mass(mjModel* model, double mass_kg) {
  constexpr std::array kParts{"gimbal_outer", "gimbal_inner", "stylus"};
  double present = 0;
  for (const char* name : kParts) present += model->body_mass[id(model, mjOBJ_BODY, name)];
  for (const char* name : kParts) {
    const int body = id(model, mjOBJ_BODY, name);
    model->body_mass[body] *= mass_kg / present;
    for (int i = 0; i < 3; ++i) model->body_inertia[3 * body + i] *= mass_kg / present;
  }
}

/// The maker's counterweight behind the shoulder carries stylus and gimbal about joint 2 at pose zero.
void add_counterweight(mjModel* model, double stylus_mass_kg, double upper_link_m) {
  const int upper = id(model, mjOBJ_BODY, "upper_link");
  models::PhantomBody weight;
  weight.mass_kg = stylus_mass_kg * upper_link_m / kCounterweightArm_m;
  weight.centre_of_mass_m = Vector3d(-kCounterweightArm_m, 0, 0);
  set_body(model, upper, joined(body_of(model, upper), weight));
}

}  // namespace

PhantomScene load_phantom(const models::DeviceSettings& settings, bool with_visuals) {
  PhantomScene scene;
  scene.model = load_scene("phantom.xml", with_visuals);
  mjModel* model = scene.model.get();
  if (settings.parameter_set == models::PhantomParameterSet::cad) use_cad_set(model);
  constexpr auto drive = models::phantom_drive();
  constexpr std::array kMotorJoints{"q1", "q2", "q3"};
  for (int i = 0; i < 3; ++i) scene.motor_dof[i] = dof(model, kMotorJoints[i]);
  scene.elbow_dof = dof(model, "elbow");
  scene.coupler_dof = dof(model, "coupler");
  scene.tip_site = id(model, mjOBJ_SITE, "tip");
  const auto mocap = [model](const char* name) { return model->body_mocapid[id(model, mjOBJ_BODY, name)]; };
  scene.hand_mocap = mocap("hand");
  scene.lower_arm_mocap = mocap("lower_arm");
  scene.upper_arm_mocap = mocap("upper_arm");
  scene.wall_mocap = mocap("wall");
  scene.upper_link_m = model->body_pos[3 * id(model, mjOBJ_BODY, "forearm")];
  scene.forearm_m = -model->site_pos[3 * scene.tip_site + 2];
  scene.crank_m = -model->body_pos[3 * id(model, mjOBJ_BODY, "coupler") + 2];
  scene.stylus_mass_kg = settings.stylus_mass_kg;
  set_stylus_mass(model, settings.stylus_mass_kg);
  if (settings.counterbalanced) add_counterweight(model, settings.stylus_mass_kg, scene.upper_link_m);
  for (int i = 0; i < 3; ++i) {
    const int address = scene.motor_dof[i];
    model->dof_damping[address] = settings.joint_viscous_Nms_per_rad;
    model->dof_frictionloss[address] = settings.joint_coulomb_Nm;
    if (settings.structural_frequency_Hz > 0) {
      // the total stays that of the set: the rotor leaves the link and is coupled back through the elastic capstan
      scene.rotor_kg_m2[i] = drive.motor.rotor_inertia_kg_m2 * drive.ratio[i] * drive.ratio[i];
      model->dof_armature[address] -= scene.rotor_kg_m2[i];
    }
  }
  const DataPtr data = make_data(model);
  mj_setConst(model, data.get());
  return scene;
}

TipState tip_state(const PhantomScene& scene, const double* qpos, const double* qvel) {
  const int q1 = scene.motor_dof[0], q2 = scene.motor_dof[1], elbow = scene.elbow_dof;
  return tip_state(scene, Vector3d(qpos[q1], qpos[q2], qpos[q2] + qpos[elbow]),
                   Vector3d(qvel[q1], qvel[q2], qvel[q2] + qvel[elbow]));
}

TipState tip_state(const PhantomScene& scene, const Vector3d& q, const Vector3d& qdot) {
  const double l1 = scene.upper_link_m, l2 = scene.forearm_m;
  const double s1 = std::sin(q[0]), c1 = std::cos(q[0]);
  const double s2 = std::sin(q[1]), c2 = std::cos(q[1]);
  const double s3 = std::sin(q[2]), c3 = std::cos(q[2]);
  const double r = l1 * c2 + l2 * s3;
  TipState tip;
  tip.position_m << c1 * r, s1 * r, l1 * s2 - l2 * c3;
  tip.jacobian << -s1 * r, -l1 * c1 * s2, l2 * c1 * c3, c1 * r, -l1 * s1 * s2, l2 * s1 * c3, 0, l1 * c2, l2 * s3;
  tip.velocity_m_per_s = tip.jacobian * qdot;
  const double rdot = -l1 * s2 * qdot[1] + l2 * c3 * qdot[2];
  const double turning = r * qdot[0] * qdot[0];
  const double outward = -l1 * c2 * qdot[1] * qdot[1] - l2 * s3 * qdot[2] * qdot[2] - turning;
  tip.bias_m_per_s2 << c1 * outward - 2 * s1 * rdot * qdot[0], s1 * outward + 2 * c1 * rdot * qdot[0],
      -l1 * s2 * qdot[1] * qdot[1] + l2 * c3 * qdot[2] * qdot[2];
  return tip;
}

}  // namespace handloop::sim
