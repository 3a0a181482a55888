#include "tests/support/planted_axes.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "tests/support/planted_fit.h"
#include "tests/support/planted_plant.h"
#include "tests/support/planted_recipes.h"

namespace handloop::tests {
namespace {

constexpr double kSampleTime = 1e-3;
constexpr double kTwoPi = 2 * std::numbers::pi;

/// Levels that change at random times, rounded by a fourth-order low-pass.
std::vector<double> random_levels(Draw& draw, std::size_t count, double amplitude, double shortest_s, double longest_s,
                                  double cutoff_Hz, bool two_levels) {
  std::vector<double> r(count);
  std::size_t i = 0;
  double level = 0;
  while (i < count) {
    level = two_levels ? (level > 0 ? -amplitude : amplitude) : draw.uniform(-amplitude, amplitude);
    const auto length = static_cast<std::size_t>(draw.uniform(shortest_s, longest_s) / kSampleTime);
    for (std::size_t end = std::min(count, i + length); i < end; ++i) r[i] = level;
  }
  if (cutoff_Hz > 0) butterworth_low_pass(r, 4, cutoff_Hz, kSampleTime);
  return r;
}

void plant_effects(const std::vector<std::string>& names, Draw& draw, const MotionScale& scale, double share_lo,
                   double share_hi, Plant& plant, PlantedRecording& out) {
  for (const std::string& name : names) {
    const Recipe r = draw_recipe(name, draw, plant, scale);
    const double s = std::clamp(r.hi * draw.log_uniform(share_lo, share_hi), r.lo, r.hi);
    r.apply(plant, s);
    out.truth.push_back({name, r.variant, r.parameters(s)});
  }
}

void name_parameters(PlantedRecording& out, const Plant& p, const std::vector<double>& fit) {
  const char* linear[] = {"mass_kg", "b_Ns_per_m", "k_N_per_m"};
  const char* rotary[] = {"inertia_kg_m2", "b_Nms_per_rad", "k_Nm_per_rad"};
  const auto& names = out.rotary ? rotary : linear;
  const double truth[] = {p.M, p.b2, p.k2};
  for (std::size_t i = 0; i < 3; ++i) {
    out.base_parameters[names[i]] = truth[i];
    out.base_fit[names[i]] = fit[i];
  }
}

/// A machine axis under a position controller, as EMPS: the drive's force and the encoder are recorded.
PlantedRecording servo_axis(const std::vector<std::string>& names, Draw& draw, double duration, bool rotary) {
  PlantedRecording out;
  out.rotary = rotary;
  out.driven_by = "position";
  Plant p;
  p.M = rotary ? draw.log_uniform(2e-3, 0.1) : draw.log_uniform(1, 100);
  p.b2 = p.M * draw.uniform(1, 4);
  const double rate = kTwoPi * draw.uniform(2.5, 5);
  Drive d;
  const auto count = static_cast<std::size_t>(duration / kSampleTime);
  const double reach = rotary ? draw.uniform(0.2, 0.6) : draw.uniform(0.03, 0.15);
  d.reference = random_levels(draw, count, reach, 0.7, 2.5, 1.5, false);
  d.force.assign(count, 0.0);
  d.servo_stiffness = p.M * rate * rate;
  d.servo_damping = 1.4 * p.M * rate;
  std::vector<double> applied;
  const std::vector<double> calm = run_plant(p, d, &applied);
  MotionScale scale;
  scale.force = rms(applied);
  scale.x = rms(calm);
  scale.v = scale.x * 4;
  plant_effects(names, draw, scale, 0.2, 0.7, p, out);
  applied.clear();
  out.position = run_plant(p, d, &applied);
  out.predictable = applied;
  double structural = names.empty() ? 0.3 * rms(applied) : fit_inverse(applied, out.position, kSampleTime).held_out_rms;
  out.noise_rms = structural / draw.log_uniform(2.5, 15);
  for (double& x : out.position) x = quantised(x, rotary ? 2e-6 : 1e-6);
  out.force = applied;
  for (double& f : out.force) f += out.noise_rms * draw.normal();
  out.hold = "held";
  const BaseFit base = fit_inverse(out.force, out.position, kSampleTime);
  name_parameters(out, p, base.parameters);
  out.rmse_floor = rms_difference(out.force, out.predictable, count * 6 / 10);
  out.rmse_base = std::hypot(structural, out.rmse_floor);
  return out;
}

/// A driven axis with a spring: an electronic Duffing circuit, a pendulum joint, a flexible arm.
PlantedRecording driven_axis(const std::vector<std::string>& names, Draw& draw, double duration, bool rotary, double lo,
                             double hi) {
  for (int attempt = 0; attempt < 6; ++attempt) {
    PlantedRecording out;
    out.rotary = rotary;
    Plant p;
    const double unit = rotary ? 0.01 : 1.0;  // inertia against mass
    p.M = unit * draw.log_uniform(0.1, 2);
    const double rate = kTwoPi * draw.uniform(1, 4);
    p.k2 = p.M * rate * rate;
    p.b2 = 2 * draw.uniform(0.1, 0.4) * p.M * rate;
    Drive d;
    const auto count = static_cast<std::size_t>(duration / kSampleTime);
    d.held = draw.chance(0.5);
    d.force = coloured_force(draw, count, kSampleTime, unit * draw.uniform(1, 2), unit * 6);
    const std::vector<double> calm = run_plant(p, d);
    MotionScale scale;
    scale.force = rms(d.force);
    scale.x = rms(calm);
    scale.v = scale.x * rate;
    plant_effects(names, draw, scale, lo, hi, p, out);
    out.predictable = run_plant(p, d);
    if (out.predictable.empty()) continue;
    const std::array<double, 3> guess{p.M, p.b2, p.k2};
    const double structural = names.empty()
                                  ? 0.2 * rms(out.predictable)
                                  : fit_axis(d.force, out.predictable, kSampleTime, d.held, guess).held_out_rms;
    out.noise_rms = structural / draw.log_uniform(2.5, 25);
    out.force = d.force;
    out.position = out.predictable;
    const double quantum = out.noise_rms * draw.uniform(0.1, 1);
    for (std::size_t i = 0; i < count; ++i) {
      out.position[i] = quantised(out.position[i] + out.noise_rms * draw.normal(), quantum);
      out.force[i] = quantised(out.force[i] + 5e-3 * scale.force * draw.normal(), 2e-3 * scale.force);
    }
    out.hold = d.held ? "held" : "interpolated";
    const BaseFit base = fit_axis(out.force, out.position, kSampleTime, d.held, guess);
    name_parameters(out, p, base.parameters);
    out.rmse_floor = rms_difference(out.position, out.predictable, count * 6 / 10);
    out.rmse_base = base.held_out_rms;
    return out;
  }
  throw std::runtime_error("no stable axis was found for this seed");
}

/// A joint moved by a stiff actuator while its torque is measured: I a + b v + k x and, later, the stretch reflex.
PlantedRecording moved_joint(Draw& draw, double duration, bool with_reflex) {
  PlantedRecording out;
  out.rotary = true;
  out.driven_by = "position";
  Plant p;
  p.M = draw.uniform(0.01, 0.02);
  p.b2 = draw.uniform(0.5, 1.5);
  p.k2 = draw.uniform(40, 150);
  const double neutral = draw.uniform(-0.2, 0.2);
  const double delay = draw.uniform(0.035, 0.06), cutoff = draw.uniform(2, 5), damping = draw.uniform(0.7, 1.0);
  const double side = draw.chance(0.5) ? 1 : -1, flip = draw.chance(0.5) ? 1 : -1;
  const double gain = p.b2 * draw.uniform(5, 14);
  const auto count = static_cast<std::size_t>(duration / kSampleTime);
  const bool steps = draw.chance(0.4);
  const std::vector<double> command =
      random_levels(draw, count, draw.uniform(0.01, 0.03), 0.15, steps ? 1.2 : 0.45, 0, !steps);

  // the actuator is a second-order system, its acceleration known at every instant; 50 us steps
  const double servo = kTwoPi * draw.uniform(10, 18), h = 5e-5, reflex_rate = kTwoPi * cutoff;
  const auto lag = static_cast<std::size_t>(delay / h);
  std::vector<double> speeds(lag + 1, 0.0);
  double x = 0, v = 0, y = 0, yv = 0;
  std::size_t head = 0;
  std::vector<double> intrinsic(count), reflex(count);
  out.position.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double pull = servo * servo * (command[i] - x) - 1.6 * servo * v;
    out.position[i] = x + neutral;
    intrinsic[i] = p.M * pull + p.b2 * v + p.k2 * x;
    reflex[i] = y;
    for (int k = 0; k < 20; ++k) {
      const double a0 = servo * servo * (command[i] - x) - 1.6 * servo * v;
      const double xm = x + 0.5 * h * v, vm = v + 0.5 * h * a0;
      x += h * vm;
      v += h * (servo * servo * (command[i] - xm) - 1.6 * servo * vm);
      speeds[head] = v;
      head = (head + 1) % speeds.size();
      const double u = gain * std::max(side * speeds[head], 0.0) * side;
      yv += h * (reflex_rate * reflex_rate * (u - y) - 2 * damping * reflex_rate * yv);
      y += h * yv;
    }
  }
  out.predictable.resize(count);
  const double bias = draw.uniform(-8, 8);  // the muscle's tone
  for (std::size_t i = 0; i < count; ++i)
    out.predictable[i] = flip * (intrinsic[i] + (with_reflex ? reflex[i] : 0.0)) + bias;
  const double structural = fit_inverse(out.predictable, out.position, kSampleTime).held_out_rms;
  const double reference = with_reflex ? structural : 0.3 * rms(intrinsic);
  const double noise = reference / draw.log_uniform(2.2, 6);
  std::vector<double> activity = slow_wander(draw, count, kSampleTime, 0.7 * noise);
  out.force.resize(count);
  for (std::size_t i = 0; i < count; ++i) out.force[i] = out.predictable[i] + activity[i] + 0.7 * noise * draw.normal();
  out.noise_rms = noise;
  out.wander_rms = 0.7 * noise;
  out.hold = "held";
  out.base_parameters = {{"inertia_kg_m2", flip * p.M}, {"b_Nms_per_rad", flip * p.b2}, {"k_Nm_per_rad", flip * p.k2}};
  const BaseFit base = fit_inverse(out.force, out.position, kSampleTime);
  out.base_fit = {{"inertia_kg_m2", base.parameters[0]},
                  {"b_Nms_per_rad", base.parameters[1]},
                  {"k_Nm_per_rad", base.parameters[2]}};
  out.rmse_floor = rms_difference(out.force, out.predictable, count * 6 / 10);
  out.rmse_base = std::hypot(structural, out.rmse_floor);
  if (with_reflex)
    out.truth.push_back({"reflex_feedback",
                         "velocity, rectified, second order",
                         {{"gain_Nms_per_rad", gain}, {"delay_s", delay}, {"cutoff_Hz", cutoff}, {"rectified", side}}});
  out.truth.push_back({"offset", "muscle tone", {{"torque_Nm", bias}}});
  return out;
}

}  // namespace

const std::vector<std::string>& planted_axes() {
  static const std::vector<std::string> names{
      "servo_coulomb_offset", "ankle_reflex", "joint_gravity",         "duffing",    "servo_damper",       "axis_none",
      "flexible_arm",         "servo_none",   "joint_gravity_coulomb", "ankle_none", "axis_coulomb_offset"};
  return names;
}

PlantedRecording plant_axis(std::string_view what, std::uint64_t seed, const PlantedOptions& options) {
  Draw draw(seed);
  const double T = options.duration_s;
  PlantedRecording out;
  if (what == "servo_coulomb_offset")
    out = servo_axis({"coulomb_friction", "offset"}, draw, T, false);
  else if (what == "servo_damper")
    out = servo_axis({"quadratic_damping"}, draw, T, false);
  else if (what == "servo_none")
    out = servo_axis({}, draw, T, draw.chance(0.5));
  else if (what == "joint_gravity_coulomb")
    out = servo_axis({"gravity", "coulomb_friction"}, draw, T, true);
  else if (what == "joint_gravity")
    out = driven_axis({"gravity"}, draw, T, true, 0.3, 1.0);
  else if (what == "duffing")
    out = driven_axis({"cubic_stiffness"}, draw, T, false, 0.05, 0.6);
  else if (what == "flexible_arm")
    out = driven_axis({"flexible_mode"}, draw, T, true, 0.3, 1.0);
  else if (what == "axis_coulomb_offset")
    out = driven_axis({"coulomb_friction", "offset"}, draw, T, false, 0.1, 0.4);
  else if (what == "axis_none")
    out = driven_axis({}, draw, T, draw.chance(0.5), 0, 0);
  else if (what == "ankle_reflex")
    out = moved_joint(draw, T, true);
  else if (what == "ankle_none")
    out = moved_joint(draw, T, false);
  else
    throw std::invalid_argument("no planted axis is called '" + std::string(what) + "'");
  out.group = PlantedGroup::axis;
  out.base = "msd";
  return out;
}

}  // namespace handloop::tests
