#include "sim/phantom_plant.h"

#include <mujoco/mujoco.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "models/errors.h"
#include "sim/arm_picture.h"
#include "sim/delay_line.h"
#include "sim/electronics.h"
#include "sim/phantom_dynamics.h"
#include "sim/signal_path.h"

namespace handloop::sim {
namespace {

using Eigen::Vector3d;
using models::Axis;

/// Faster than this the numbers are an explosion and not a motion.
constexpr double kFastestTip_m_per_s = 1e3;

const models::Scenario& require_phantom(const models::Scenario& scenario) {
  if (scenario.device.model != models::DeviceModel::phantom_premium_1_5) {
    throw InputError("device.model: this plant simulates phantom_premium_1_5 only");
  }
  return scenario;
}

/// Force that needs the tip's acceleration to be known: what hangs between sensor and arm.
bool mass_beyond_the_sensor(const models::Scenario& scenario) {
  return scenario.arm.force_sensed_at == models::ForceSensedAt::flange ||
         std::ranges::any_of(scenario.arm.rigid, [](const auto& rigid) { return rigid.has_value(); }) ||
         std::ranges::any_of(scenario.arm.effects, [](const auto& entry) {
           return entry.second->place() != models::Place::arm && entry.second->added_mass_kg(1.0) != 0;
         });
}

}  // namespace

struct PhantomPlant::Impl {
  models::Scenario scenario;
  Electronics electronics;
  PhantomDynamics dynamics;
  PlantDescription description;
  bool needs_acceleration;
  std::array<SignalPath, 3> sensor;  // by axis
  std::array<DelayLine, 3> sensor_past;
  std::array<double, 3> sensor_input{};

  std::uint64_t sample = 0;
  std::array<double, kMotors> current_A{};
  PlantTruth seen;                         // as of the present sample
  std::array<double, 3> sensed_force_N{};  // device frame
  Vector3d encoder_shift_rad = Vector3d::Zero();

  Impl(const models::Scenario& wanted, const PlantOptions& options)
      : scenario(require_phantom(wanted)),
        electronics(wanted),
        dynamics(wanted, options.with_visuals),
        description(electronics.describe()),
        needs_acceleration(mass_beyond_the_sensor(wanted)) {
    description.physics_step_s = dynamics.step_s();
    for (std::size_t i = 0; i < kMotors; ++i) description.encoder_zero_rad[i] = scenario.device.pose_rad[i];
    for (const Axis axis : models::kAxes) {
      const auto i = static_cast<std::size_t>(axis);
      sensor[i] = SignalPath(effects_of(scenario, axis), models::Place::sensor, scenario.loop.sample_time_s);
      sensor_past[i] = DelayLine(std::max(sensor[i].delay_s(), 1e-9), scenario.loop.sample_time_s);
    }
    reset();
  }

  void reset() noexcept {
    dynamics.reset();
    for (std::size_t i = 0; i < 3; ++i) {
      sensor[i].reset();
      sensor_past[i].reset();
    }
    sensor_input = {};
    sample = 0;
    current_A = {};
    seen = {};
    observe();
  }

  void advance(const PlantCommand& command) noexcept {
    current_A = electronics.currents_A(command);
    if (!seen.diverged) {
      Vector3d torque;
      for (std::size_t i = 0; i < kMotors; ++i) {
        torque[static_cast<Eigen::Index>(i)] = electronics.joint_torque_Nm(i, current_A[i]);
      }
      dynamics.advance(sample, torque);
    }
    ++sample;
    if (!seen.diverged) observe();
  }

  void observe() noexcept {
    const double t = static_cast<double>(sample) * scenario.loop.sample_time_s;
    const TipState tip = dynamics.tip();
    if (!(tip.velocity_m_per_s.norm() < kFastestTip_m_per_s) || !tip.position_m.allFinite()) {
      seen.diverged = true;
      return;
    }
    const auto reaction = dynamics.reaction(t, tip);
    Vector3d sensed = reaction.force_N;
    Vector3d flange = Vector3d::Zero();
    if (needs_acceleration) {
      const Vector3d acceleration = dynamics.tip_acceleration(tip, reaction);
      sensed += reaction.inertia_kg.cwiseProduct(acceleration);
      flange = sensed + dynamics.scene().stylus_mass_kg * acceleration;
      if (scenario.arm.force_sensed_at == models::ForceSensedAt::flange) sensed = flange;
    }
    for (const Axis axis : models::kAxes) {
      const auto i = static_cast<std::size_t>(axis);
      const int row = models::device_row(axis);
      seen.tip_m[i] = tip.position_m[row] - dynamics.tip_at_pose_m()[row];
      seen.tip_m_per_s[i] = tip.velocity_m_per_s[row];
      seen.hand_force_N[i] = reaction.grasp_N[row];
      seen.flange_force_N[i] = flange[row];
      seen.arm_mass_m[i] = dynamics.arm(axis).position_m();
      sensed_force_N[static_cast<std::size_t>(row)] = sensed[row];
    }
    for (std::size_t i = 0; i < kMotors; ++i) {
      seen.joint_rad[i] = dynamics.motor_side_rad(i);
      seen.joint_rad_per_s[i] = dynamics.motor_side_rad_per_s(i);
    }
    seen.t_s = t;
    seen.grip_force_N = scenario.arm.attached ? scenario.arm.grip_force_N : 0.0;
    seen.motor_current_A = current_A;
    seen.loop_gap_m = dynamics.loop_gap_m();
    sense_position(t, tip);
  }

  /// Effects on the position signal shift what the encoders say by J^-1 of the shift along their axis.
  void sense_position(double t_s, const TipState& tip) noexcept {
    Vector3d shift = Vector3d::Zero();
    for (const Axis axis : models::kAxes) {
      const auto i = static_cast<std::size_t>(axis);
      if (sensor[i].empty()) continue;
      const DelayLine::Motion now{seen.tip_m[i], seen.tip_m_per_s[i]};
      sensor_past[i].push(t_s, now);
      const double late = sensor[i].delay_s() > 0 ? sensor_past[i].at_delay(t_s, now).x_m : now.x_m;
      if (sample > 0) sensor[i].step(sensor_input[i], late);
      sensor_input[i] = late;
      shift[models::device_row(axis)] = sensor[i].output(late) + sensor[i].addition(t_s) - now.x_m;
    }
    encoder_shift_rad = shift.isZero(0.0) ? shift : Vector3d(tip.jacobian.partialPivLu().solve(shift));
  }

  PlantReading read() const noexcept {
    PlantReading reading;
    reading.sample = sample;
    for (std::size_t i = 0; i < kMotors; ++i) {
      const double turned = seen.joint_rad[i] - scenario.device.pose_rad[i];
      reading.encoder_counts[i] =
          electronics.encoder_counts(i, turned + encoder_shift_rad[static_cast<Eigen::Index>(i)]);
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
void PhantomPlant::set_pull(const Pull& pull) noexcept {
  impl_->dynamics.set_pull(pull);
}
void PhantomPlant::reset() noexcept {
  impl_->reset();
}
PlantTruth PhantomPlant::truth() const noexcept {
  return impl_->seen;
}
double PhantomPlant::energy_J() {
  return impl_->dynamics.energy_J(impl_->seen.t_s);
}
const mjModel* PhantomPlant::mujoco_model() const {
  return impl_->dynamics.scene().model.get();
}

mjData* PhantomPlant::picture() {
  auto& dynamics = impl_->dynamics;
  pose_picture(dynamics.scene(), dynamics.tip_at_pose_m(), impl_->seen, impl_->scenario.wall, dynamics.data());
  return dynamics.data();
}

}  // namespace handloop::sim
