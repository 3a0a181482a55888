#include "sim/seven_bar_plant.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "models/errors.h"
#include "models/random.h"
#include "models/seven_bar.h"
#include "models/transducers.h"
#include "sim/electronics.h"
#include "sim/scene_file.h"
#include "sim/seven_bar_hand.h"

namespace handloop::sim {
namespace {

using Eigen::Vector2d;

constexpr double kFastest_rad_per_s = 1e3;
constexpr double kTorque_Nm_per_A = 5.0;  ///< direct drive: 20 A make the 100 Nm we assume
constexpr double kGripScale_N_per_V = 10.0;
constexpr double kLightest_kg = 1e-4;  ///< of a handle nobody holds

/// Indices of the scene by their names.
struct Names {
  std::array<int, 2> motor_dof{}, motor{};
  int th3, link2, link5, link6;
  int handle, load, handle_site, load_site, hand_force, environment_force;

  explicit Names(const mjModel* m) {
    const auto dof = [&](const char* joint) { return m->jnt_dofadr[mj_name2id(m, mjOBJ_JOINT, joint)]; };
    motor_dof = {dof("th1"), dof("th6")};
    motor = {mj_name2id(m, mjOBJ_ACTUATOR, "motor1"), mj_name2id(m, mjOBJ_ACTUATOR, "motor2")};
    th3 = dof("th3");
    link2 = dof("link2");
    link5 = dof("link5");
    link6 = dof("link6");
    handle = mj_name2id(m, mjOBJ_BODY, "handle");
    load = mj_name2id(m, mjOBJ_BODY, "load");
    handle_site = mj_name2id(m, mjOBJ_SITE, "hand_sensor");
    load_site = mj_name2id(m, mjOBJ_SITE, "environment_sensor");
    hand_force = m->sensor_adr[mj_name2id(m, mjOBJ_SENSOR, "hand_force")];
    environment_force = m->sensor_adr[mj_name2id(m, mjOBJ_SENSOR, "environment_force")];
  }
};

const models::Scenario& require_seven_bar(const models::Scenario& scenario) {
  if (scenario.device.model != models::DeviceModel::seven_bar) {
    throw InputError("device.model: this plant simulates seven_bar only");
  }
  return scenario;
}

int substeps(const models::Scenario& scenario) {
  return static_cast<int>(std::ceil(scenario.loop.sample_time_s / scenario.run.physics_step_s - 1e-9));
}

}  // namespace

struct SevenBarPlant::Impl {
  models::Scenario scenario;
  models::ElectronicsSettings settings;
  ModelPtr model;
  Names name;
  DataPtr data;
  models::Converter dac, adc;
  models::Amplifier amplifier;
  models::Encoder resolver;
  std::array<models::CounterRandom, 4> force_noise;
  PlantDescription description;
  models::SevenBarStops stops;
  Vector2d pose, home_m;
  int steps_per_sample;
  SevenBarHandModel hand;
  OutsideForce muscle, outside;

  std::uint64_t sample = 0;
  Vector2d torque = Vector2d::Zero();
  SevenBarTruth seen;
  std::array<double, 4> sensed_N{};  ///< on hand and load, axes of link 6

  Impl(const models::Scenario& wanted, const PlantOptions& options)
      : scenario(require_seven_bar(wanted)),
        settings(effective(wanted.electronics)),
        model(load_scene("seven_bar.xml", options.with_visuals)),
        name(model.get()),
        dac{settings.dac_bits, settings.dac_range_V},
        adc{settings.adc_bits, settings.adc_range_V},
        amplifier{settings.amplifier_A_per_V, settings.current_limit_A},
        resolver{settings.encoder_counts_per_rev},
        force_noise{noise(0), noise(1), noise(2), noise(3)},
        pose(wanted.device.pose_rad[0], wanted.device.pose_rad[1]),
        home_m(models::seven_bar_handle({}, pose)),
        steps_per_sample(substeps(wanted)),
        hand(wanted, wanted.loop.sample_time_s / steps_per_sample) {
    require_reachable();
    const auto load = static_cast<std::size_t>(name.load);
    model->body_mass[load] = std::max(scenario.force_amplifier.load_kg, kLightest_kg);
    model->opt.timestep = scenario.loop.sample_time_s / steps_per_sample;
    // Short steps make the cheap integrator exact enough, and it lets a step be split where the command comes in.
    model->opt.integrator = mjINT_EULER;
    stiffen_loops();
    take_hold(scenario.arm.attached);
    data = make_data(model.get());
    mj_setConst(model.get(), data.get());
    describe();
    reset();
  }

  /// Pins of the four-bars as stiff as the step allows: those of the scene, made for 1 ms, would turn the phase by ten
  /// degrees where the force loop crosses.
  void stiffen_loops() {
    const double step_s = model->opt.timestep;
    for (int i = 0; i < model->neq; ++i) {
      model->eq_solref[mjNREF * i] = -0.25 / (step_s * step_s);
      model->eq_solref[mjNREF * i + 1] = -1.0 / step_s;
    }
  }

  models::CounterRandom noise(std::uint32_t channel) const {
    return {scenario.run.seed, models::RandomStream::sensor_noise, 20 + channel};
  }

  void require_reachable() const {
    for (std::size_t i = 0; i < 2; ++i) {
      if (scenario.device.pose_rad[i] < stops.lower_rad[i] || scenario.device.pose_rad[i] > stops.upper_rad[i]) {
        throw InputError("device.pose_rad: the seven-bar's th3 and th6 lie within -2.75 to -0.35 and -1.25 to 1.25");
      }
    }
    const double elbow = pose[1] - pose[0];
    if (elbow < stops.elbow_lower_rad || elbow > stops.elbow_upper_rad) {
      throw InputError("device.pose_rad: the seven-bar's th6 - th3 lies within 0.31 and 2.83");
    }
  }

  void take_hold(bool held) noexcept {
    seen.held = held;
    model->body_mass[name.handle] = held ? hand.mass_kg() : kLightest_kg;
  }

  void describe() {
    for (std::size_t i = 0; i < kMotors; ++i) {
      description.encoder_rad_per_count[i] = resolver.resolution_rad();
      description.transmission_ratio[i] = 1.0;
      description.torque_Nm_per_A[i] = kTorque_Nm_per_A;
    }
    for (std::size_t i = 0; i < kSevenBarMotors; ++i) {
      description.encoder_zero_rad[i] = scenario.device.pose_rad[i];
    }
    for (std::size_t i = 0; i < 4; ++i) description.analog_N_per_V[i] = settings.force_sensor_N_per_V;
    description.analog_N_per_V[4] = kGripScale_N_per_V;
    describe_converters(settings, description);
    description.sample_time_s = scenario.loop.sample_time_s;
    description.physics_step_s = model->opt.timestep;
  }

  void reset() noexcept {
    seen = {};
    take_hold(scenario.arm.attached);
    mj_resetData(model.get(), data.get());
    data->qpos[name.motor_dof[0]] = data->qpos[name.th3] = pose[0];
    data->qpos[name.motor_dof[1]] = pose[1];
    data->qpos[name.link2] = -pose[0];
    data->qpos[name.link6] = pose[1] - pose[0];
    data->qpos[name.link5] = pose[0] - pose[1];
    hand.reset();
    sample = 0;
    // Until the first command the motors carry the weight, so that the start is one at rest.
    models::SevenBarParameters device;
    device.load_kg = scenario.force_amplifier.load_kg;
    torque = models::seven_bar_gravity(models::seven_bar_inertia(device), pose);
    seen.torque_Nm = torque;
    mj_forward(model.get(), data.get());  // where things are, before forces depend on it
    apply_outside(0.0);
    apply_torque();
    mj_forward(model.get(), data.get());
    observe();
  }

  Vector2d place(int site) const { return {data->site_xpos[3 * site], data->site_xpos[3 * site + 2]}; }

  Vector2d handle_velocity() const {
    const Vector2d th(data->qpos[name.motor_dof[0]], data->qpos[name.motor_dof[1]]);
    const Vector2d rate(data->qvel[name.motor_dof[0]], data->qvel[name.motor_dof[1]]);
    const models::SevenBarParameters device;
    return models::seven_bar_jacobian(device, th, device.handle_m) * rate;
  }

  void push(int body, const Vector2d& force_N) noexcept {
    data->xfrc_applied[6 * body] = force_N[0];
    data->xfrc_applied[6 * body + 2] = force_N[1];
  }

  /// Forces of arm and outside over the step that begins now.
  void apply_outside(double t) noexcept {
    if (seen.held) {
      const Vector2d wanted = muscle ? muscle(t) : hand.irregular_force_N(t);
      Vector2d force = hand.step(wanted, seen.hand_force_N, place(name.handle_site) - home_m, handle_velocity());
      force[1] += model->body_mass[name.handle] * -model->opt.gravity[2];  // the shoulder carries the arm's weight
      push(name.handle, force);
    } else {
      push(name.handle, Vector2d::Zero());
    }
    push(name.load, outside ? outside(t) : Vector2d(Vector2d::Zero()));
  }

  /// A limit switch on the shaft takes the motor's current away.
  void apply_torque() noexcept {
    for (std::size_t i = 0; i < 2; ++i) {
      const double th = data->qpos[name.motor_dof[i]];
      seen.switched_off[i] =
          th < stops.lower_rad[i] + stops.switch_inside_rad || th > stops.upper_rad[i] - stops.switch_inside_rad;
      data->ctrl[name.motor[i]] = seen.switched_off[i] ? 0.0 : torque[static_cast<Eigen::Index>(i)];
    }
  }

  void advance(const PlantCommand& command) noexcept {
    for (std::size_t i = 0; i < 2; ++i) {
      torque[static_cast<Eigen::Index>(i)] = kTorque_Nm_per_A * amplifier.current_A(dac.volt(command.dac_codes[i]));
    }
    const double leaves = scenario.force_amplifier.hand_leaves_s;
    if (seen.held && leaves > 0.0 && seen.t_s >= leaves) take_hold(false);
    for (int k = 0; k < steps_per_sample && !seen.diverged; ++k) {
      const double t = static_cast<double>(sample) * scenario.loop.sample_time_s + k * model->opt.timestep;
      apply_outside(t);
      apply_torque();
      // Positions and velocities of the first step are those that observe() worked out.
      if (k > 0) mj_step1(model.get(), data.get());
      mj_step2(model.get(), data.get());
    }
    ++sample;
    if (seen.diverged) return;
    mj_forward(model.get(), data.get());
    observe();
  }

  Vector2d sensed_in_room(int address) const {
    // Of link 6 on what hangs there, turned from its axes to the room's; the device feels the opposite.
    const double th6 = data->qpos[name.motor_dof[1]], c = std::cos(th6), s = std::sin(th6);
    const double* f = data->sensordata + address;
    return {c * f[0] - s * f[2], s * f[0] + c * f[2]};
  }

  void observe() noexcept {
    for (std::size_t i = 0; i < 2; ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      seen.joint_rad[row] = data->qpos[name.motor_dof[i]];
      seen.joint_rad_per_s[row] = data->qvel[name.motor_dof[i]];
      seen.torque_Nm[row] = data->ctrl[name.motor[i]];
    }
    if (!(seen.joint_rad_per_s.norm() < kFastest_rad_per_s) || !seen.joint_rad.allFinite()) {
      seen.diverged = true;
      return;
    }
    seen.t_s = static_cast<double>(sample) * scenario.loop.sample_time_s;
    seen.handle_m = place(name.handle_site) - home_m;
    seen.handle_m_per_s = handle_velocity();
    seen.hand_force_N = -sensed_in_room(name.hand_force);
    seen.environment_force_N = -sensed_in_room(name.environment_force);
    seen.muscle_force_N = seen.held ? hand.intended_N() : Vector2d(Vector2d::Zero());
    sensed_N = {data->sensordata[name.hand_force], data->sensordata[name.hand_force + 2],
                data->sensordata[name.environment_force], data->sensordata[name.environment_force + 2]};
    double square = 0;
    for (int i = 0; i < data->ne; ++i) square += data->efc_pos[i] * data->efc_pos[i];
    seen.loop_gap_m = std::sqrt(square);
  }

  PlantReading read() const noexcept {
    PlantReading reading;
    reading.sample = sample;
    for (std::size_t i = 0; i < kSevenBarMotors; ++i) {
      const double turned = seen.joint_rad[static_cast<Eigen::Index>(i)] - scenario.device.pose_rad[i];
      reading.encoder_counts[i] = resolver.counts(turned + 0.5 * resolver.resolution_rad());
    }
    reading.adc_codes.fill(adc.code(0.0));
    for (std::size_t i = 0; i < 4; ++i) {
      const double noise_N = settings.force_noise_N > 0 ? settings.force_noise_N * force_noise[i].normal(sample) : 0.0;
      reading.adc_codes[i] = adc.code((sensed_N[i] + noise_N) / settings.force_sensor_N_per_V);
    }
    reading.adc_codes[4] = adc.code((seen.held ? kSevenBarGrip_N : 0.0) / kGripScale_N_per_V);
    return reading;
  }
};

SevenBarPlant::SevenBarPlant(const models::Scenario& scenario, const PlantOptions& options)
    : impl_(std::make_unique<Impl>(scenario, options)) {}
SevenBarPlant::~SevenBarPlant() = default;
SevenBarPlant::SevenBarPlant(SevenBarPlant&&) noexcept = default;
SevenBarPlant& SevenBarPlant::operator=(SevenBarPlant&&) noexcept = default;

const PlantDescription& SevenBarPlant::description() const {
  return impl_->description;
}
PlantReading SevenBarPlant::read() const noexcept {
  return impl_->read();
}
void SevenBarPlant::advance(const PlantCommand& command) noexcept {
  impl_->advance(command);
}
void SevenBarPlant::reset() noexcept {
  impl_->reset();
}
SevenBarTruth SevenBarPlant::truth() const noexcept {
  return impl_->seen;
}
void SevenBarPlant::set_muscle_force(OutsideForce force) {
  impl_->muscle = std::move(force);
}
void SevenBarPlant::set_environment_force(OutsideForce force) {
  impl_->outside = std::move(force);
}
Vector2d SevenBarPlant::scenario_muscle_force_N(double t_s) const {
  return impl_->hand.irregular_force_N(t_s);
}
const mjModel* SevenBarPlant::mujoco_model() const {
  return impl_->model.get();
}
mjData* SevenBarPlant::picture() {
  return impl_->data.get();
}

}  // namespace handloop::sim
