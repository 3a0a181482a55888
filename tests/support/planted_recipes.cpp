#include "tests/support/planted_recipes.h"

#include <cmath>
#include <numbers>
#include <stdexcept>

namespace handloop::tests {
namespace {

using Values = std::map<std::string, double>;
constexpr double kTwoPi = 2 * std::numbers::pi;

Recipe friction(Draw& draw, const Plant&, const MotionScale& scale, bool stribeck) {
  const int kind = draw.pick(3);
  const double width = draw.log_uniform(2e-4, 3e-3);
  const double bristle = draw.log_uniform(3e-5, 1e-4);
  const double excess = stribeck ? draw.uniform(0.5, 1.5) : 0.0;
  const double fade = draw.log_uniform(8e-3, 5e-2);
  Recipe r;
  r.variant = kind == 0 ? "tanh" : kind == 1 ? "exact stick-slip" : "bristle";
  r.lo = 0.01 * scale.force;
  r.hi = (stribeck ? 0.5 : 0.8) * scale.force;
  r.apply = [=](Plant& p, double s) {
    p.friction = kind == 0 ? Plant::Friction::smooth : kind == 1 ? Plant::Friction::exact : Plant::Friction::bristle;
    p.friction_force = s;
    p.breakaway_excess = excess * s;
    p.stribeck_velocity = fade;
    p.smoothing_velocity = stribeck ? std::min(width, 1e-3) : width;
    p.bristle_length = bristle;
  };
  r.parameters = [=](double s) {
    Values v{{"force_N", s}};
    if (stribeck) {
      v["static_force_N"] = s * (1 + excess);
      v["stribeck_velocity_m_per_s"] = fade;
    }
    return v;
  };
  return r;
}

Recipe reflex(Draw& draw, const Plant& arm, const MotionScale&) {
  const bool rectified = draw.chance(0.4), of_position = draw.chance(0.3);
  const int order = draw.chance(0.7) ? 1 : 2;
  const double delay = draw.uniform(0.02, 0.06), cutoff = draw.uniform(2, 5);
  const double direction = draw.chance(0.5) ? 1 : -1;
  const double sign = draw.chance(0.75) ? 1 : -1;  // some loops help the motion, most resist it
  Recipe r;
  r.variant = std::string(of_position ? "position" : "velocity") + (rectified ? ", rectified" : "") +
              (order == 2 ? ", second order" : ", first order");
  const double unit = of_position ? arm.k2 : arm.b2;
  r.lo = 0.03 * unit;
  r.hi = (of_position ? 1.2 : 6.0) * unit;
  r.apply = [=](Plant& p, double s) {
    p.reflex_gain = sign * s;
    p.reflex_delay = delay;
    p.reflex_rate = kTwoPi * cutoff;
    p.reflex_order = order;
    p.reflex_rectified = rectified;
    p.reflex_of_position = of_position;
    p.reflex_direction = direction;
  };
  r.parameters = [=](double s) {
    return Values{{of_position ? "gain_N_per_m" : "gain_Ns_per_m", sign * s},
                  {"delay_s", delay},
                  {"cutoff_Hz", cutoff},
                  {"order", order},
                  {"rectified", rectified ? direction : 0}};
  };
  return r;
}

Recipe drift(Draw& draw, const Plant&, const MotionScale&) {
  const int which = draw.pick(4), shape = draw.pick(3);
  const double sign = draw.chance(0.5) ? 1 : -1;
  const double time = shape == 1 ? draw.uniform(8, 40) : draw.uniform(2, 8);
  const char* names[] = {"k2", "b2", "k1", "M"};
  const char* shapes[] = {"linear", "exponential", "smooth step"};
  Recipe r;
  r.variant = std::string(names[which]) + ", " + shapes[shape];
  r.lo = 0.03;
  r.hi = sign > 0 ? 1.5 : 0.6;
  r.apply = [=](Plant& p, double s) {
    p.drifts = std::array{Plant::Drifts::k2, Plant::Drifts::b2, Plant::Drifts::k1, Plant::Drifts::M}[which];
    p.drift_shape =
        std::array{Plant::DriftShape::linear, Plant::DriftShape::exponential, Plant::DriftShape::step}[shape];
    p.drift_amount = sign * s;
    p.drift_time = time;
  };
  r.parameters = [=](double s) {
    return Values{{std::string("relative_") + names[which], sign * s}, {"time_s", time}};
  };
  return r;
}

Recipe flexible_mode(Draw& draw, const Plant& arm, const MotionScale&) {
  const bool absorber = draw.chance(0.6);
  const double frequency = draw.uniform(8, 22), damping = draw.uniform(0.02, 0.1);
  Recipe r;
  r.variant = absorber ? "absorber on the arm" : "mode added to the grip";
  r.lo = absorber ? 0.01 * arm.M : 0.005 / arm.k1;
  r.hi = absorber ? 0.35 * arm.M : 0.5 / arm.k1;
  r.apply = [=](Plant& p, double s) {
    if (absorber) {
      p.absorber_mass = s;
      p.absorber_rate = kTwoPi * frequency;
      p.absorber_damping = damping;
    } else {
      p.mode_compliance = s;
      p.mode_rate = kTwoPi * frequency;
      p.mode_damping = damping;
    }
  };
  r.parameters = [=](double s) {
    return Values{
        {absorber ? "mass_kg" : "compliance_m_per_N", s}, {"frequency_Hz", frequency}, {"damping_ratio", damping}};
  };
  return r;
}

Recipe hysteresis(Draw& draw, const Plant&, const MotionScale& scale) {
  const double length = draw.uniform(0.15, 0.9) * scale.x, beta = draw.uniform(0.5, 0.9);
  const double exponent = std::array{1.0, 1.5, 2.0}[static_cast<std::size_t>(draw.pick(3))];
  Recipe r;
  r.variant = "Bouc-Wen, n = " + std::to_string(exponent).substr(0, 3);
  r.lo = 0.01 * scale.force;
  r.hi = 0.8 * scale.force;
  r.apply = [=](Plant& p, double s) {
    p.bw_force = s;
    p.bw_length = length;
    p.bw_beta = beta;
    p.bw_gamma = 1 - beta;
    p.bw_exponent = exponent;
  };
  r.parameters = [=](double s) {
    return Values{{"force_N", s}, {"length_m", length}, {"beta", beta}, {"exponent", exponent}};
  };
  return r;
}

Recipe ripple(Draw& draw, const Plant& arm, const MotionScale& scale) {
  const double period = draw.uniform(1e-3, 1e-2), phase = draw.uniform(0, kTwoPi);
  const bool at_grip = arm.k1 > 0 && draw.chance(0.3);
  Recipe r;
  r.variant = at_grip ? "at the grip" : "at the arm";
  r.lo = 0.01 * scale.force;
  r.hi = 0.5 * scale.force;
  r.apply = [=](Plant& p, double s) {
    p.ripple_force = s;
    p.ripple_period = period;
    p.ripple_phase = phase;
    p.ripple_at_grip = at_grip;
  };
  r.parameters = [=](double s) { return Values{{"force_N", s}, {"period_m", period}, {"phase_rad", phase}}; };
  return r;
}

/// Effects of one number: a member of Plant and the strength that goes into it.
Recipe simple(std::string variant, std::string unit_name, double lo, double hi,
              std::function<void(Plant&, double)> apply, Values more = {}) {
  Recipe r;
  r.variant = std::move(variant);
  r.lo = lo;
  r.hi = hi;
  r.apply = std::move(apply);
  r.parameters = [unit_name, more](double s) {
    Values v = more;
    v[unit_name] = s;
    return v;
  };
  return r;
}

Recipe catalogued(std::string_view name, Draw& draw, const Plant& arm, const MotionScale& m) {
  const double f = m.force;
  if (name == "coulomb_friction") return friction(draw, arm, m, false);
  if (name == "stribeck_friction") return friction(draw, arm, m, true);
  if (name == "reflex_feedback") return reflex(draw, arm, m);
  if (name == "parameter_drift") return drift(draw, arm, m);
  if (name == "flexible_mode") return flexible_mode(draw, arm, m);
  if (name == "hysteresis") return hysteresis(draw, arm, m);
  if (name == "position_ripple") return ripple(draw, arm, m);
  if (name == "quadratic_damping")
    return simple("on the arm", "drag_Ns2_per_m2", 0.02 * f / (m.v * m.v), 2 * f / (m.v * m.v),
                  [](Plant& p, double s) { p.drag = s; });
  if (name == "cubic_stiffness") {
    if (arm.k1 > 0 && draw.chance(0.25))
      return simple("on the grasp", "k3_N_per_m3", 0.02 * f / std::pow(m.grasp, 3), 2 * f / std::pow(m.grasp, 3),
                    [](Plant& p, double s) { p.cubic_grasp = s; });
    return simple("on the arm", "k3_N_per_m3", 0.01 * f / std::pow(m.x, 3), 2 * f / std::pow(m.x, 3),
                  [](Plant& p, double s) { p.cubic_arm = s; });
  }
  if (name == "asymmetric_stiffness") {
    const double corner = draw.chance(0.5) ? 0.0 : draw.uniform(0.05, 0.3) * m.x;
    return simple(corner > 0 ? "rounded corner" : "sharp corner", "side_N_per_m", 0.03 * arm.k2, 2 * arm.k2,
                  [corner](Plant& p, double s) {
                    p.side_stiffness = s;
                    p.side_corner = corner;
                  });
  }
  if (name == "backlash")
    return simple("dead zone of the grasp", "gap_m", 2e-4, 2e-3, [](Plant& p, double s) { p.gap = s; });
  if (name == "viscoelastic_relaxation") {
    const double time = draw.log_uniform(0.05, 1.0);
    const bool grasp = draw.chance(0.2);
    return simple(grasp ? "Maxwell in the grasp" : "Maxwell on the arm", "k_N_per_m", 0.03 * (grasp ? arm.k1 : arm.k2),
                  2 * (grasp ? arm.k1 : arm.k2),
                  [=](Plant& p, double s) {
                    p.maxwell_stiffness = s;
                    p.maxwell_time = time;
                    p.maxwell_in_grasp = grasp;
                  },
                  {{"time_s", time}});
  }
  if (name == "time_delay") {  // whole steps of the integrator, so that the delay is exactly what is written down
    const auto whole = [](double delay) { return 5e-5 * std::round(delay / 5e-5); };
    Recipe r =
        simple("on the force", "delay_s", 2e-3, 2e-2, [whole](Plant& p, double t) { p.transport_delay = whole(t); });
    r.parameters = [whole](double t) { return Values{{"delay_s", whole(t)}}; };
    return r;
  }
  if (name == "sensor_lag")
    return simple("first order", "lag_s", 2e-3, 2e-2, [](Plant& p, double s) { p.lag_time = s; });
  if (name == "added_mass")
    return simple("beyond the sensor", "mass_kg", 0.02, 0.1, [](Plant& p, double s) { p.grip_mass = s; });
  if (name == "offset") {
    const double sign = draw.chance(0.5) ? 1 : -1;
    return simple("of the force", sign > 0 ? "force_N" : "negative_force_N", 0.01 * f, 0.5 * f,
                  [sign](Plant& p, double s) { p.force_offset = sign * s; });
  }
  if (name == "gravity") {
    const double angle = draw.uniform(-1.2, 1.2);
    return simple("pendulum", "moment_Nm", 0.1 * f, 3 * f,
                  [angle](Plant& p, double s) {
                    p.gravity_moment = s;
                    p.gravity_angle = angle;
                  },
                  {{"angle_rad", angle}});
  }
  if (name == "tremor") {
    Recipe r = simple("narrow-band force on the arm", "rms_N", 0.005 * f, 3 * f,
                      [](Plant& p, double s) { p.tremor_force = s; });
    r.tremor = true;
    r.tremor_Hz = draw.uniform(6, 12);
    r.tremor_bandwidth_Hz = draw.uniform(0.2, 1.0);
    const double frequency = r.tremor_Hz;
    r.parameters = [frequency](double s) { return Values{{"rms_N", s}, {"frequency_Hz", frequency}}; };
    return r;
  }
  return {};
}

Recipe outsider(std::string_view name, Draw& draw, const Plant& arm, const MotionScale& m) {
  const double f = m.force, width = draw.log_uniform(5e-4, 3e-3);
  if (name == "one_sided_stop" || name == "two_sided_stop") {
    const double at = draw.uniform(0.5, 1.3) * m.x;
    const bool both = name == "two_sided_stop";
    return simple(both ? "both sides" : "one side", "stop_N_per_m", 0.3 * arm.k2, 8 * arm.k2,
                  [=](Plant& p, double s) {
                    p.stop_stiffness = s;
                    p.stop_at = at;
                    p.stop_two_sided = both;
                  },
                  {{"at_m", at}});
  }
  if (name == "abs_x_damping")
    return simple("|x| v", "c_Ns_per_m2", 0.05 * f / (m.x * m.v), 3 * f / (m.x * m.v),
                  [](Plant& p, double s) { p.absx_damping = s; });
  if (name == "x_squared_damping")
    return simple("x^2 v", "c_Ns_per_m3", 0.03 * f / (m.x * m.x * m.v), 3 * f / (m.x * m.x * m.v),
                  [](Plant& p, double s) { p.x2_damping = s; });
  if (name == "speed_dependent_stiffness")
    return simple("|v| x", "c_Ns_per_m2", 0.05 * f / (m.x * m.v), 3 * f / (m.x * m.v),
                  [](Plant& p, double s) { p.speed_stiffness = s; });
  if (name == "friction_with_distance")
    return simple("|x| sign v", "mu_N_per_m", 0.05 * f / m.x, 1.5 * f / m.x, [width](Plant& p, double s) {
      p.absx_friction = s;
      p.smoothing_velocity = width;
    });
  if (name == "arm_freeplay")
    return simple("dead zone of k2", "width_m", 0.1 * m.x, 1.5 * m.x, [](Plant& p, double s) { p.arm_freeplay = s; });
  if (name == "saturating_force") {
    const double length = draw.uniform(0.15, 0.5) * m.x;
    return simple("tanh x", "force_N", 0.03 * f, 1.0 * f,
                  [length](Plant& p, double s) {
                    p.saturating_force = s;
                    p.saturating_length = length;
                  },
                  {{"length_m", length}});
  }
  if (name == "direction_dependent_stiffness")
    return simple("x where v > 0", "k_N_per_m", 0.05 * arm.k2, 1.0 * arm.k2, [width](Plant& p, double s) {
      p.forward_stiffness = s;
      p.smoothing_velocity = 5 * width;
    });
  if (name == "root_damping")
    return simple("sqrt|v| sign v", "c", 0.03 * f / std::sqrt(m.v), 1.5 * f / std::sqrt(m.v),
                  [](Plant& p, double s) { p.root_damping = s; });
  return {};
}

}  // namespace

Recipe draw_recipe(std::string_view name, Draw& draw, const Plant& arm, const MotionScale& scale) {
  Recipe r = catalogued(name, draw, arm, scale);
  if (!r.apply) r = outsider(name, draw, arm, scale);
  if (!r.apply) throw std::invalid_argument("nothing is known of planting '" + std::string(name) + "'");
  r.name = name;
  return r;
}

}  // namespace handloop::tests
