#include "tests/support/planted_recording.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "tests/support/planted_axes.h"
#include "tests/support/planted_fit.h"
#include "tests/support/planted_recipes.h"

namespace handloop::tests {
namespace {

constexpr double kSampleTime = 1e-3;

// Tables I (grip force 1, 2, 3 N for X, Y, Z) and II (nominal X, Y, Z) of the arm paper: M, k1, k2, b1, b2.
constexpr std::array<std::array<double, 5>, 12> kArms{{{0.2892, 428.4, 99.45, 2.998, 5.802},
                                                       {0.2869, 448.6, 93.93, 2.443, 5.698},
                                                       {0.2731, 455.5, 96.17, 2.325, 5.629},
                                                       {0.4602, 469.69, 121.8, 7.063, 5.996},
                                                       {0.3892, 625.94, 122.2, 5.996, 6.005},
                                                       {0.4186, 671.20, 126.0, 5.858, 6.410},
                                                       {0.2115, 843.1, 323.9, 0.7093, 19.42},
                                                       {0.2525, 868.3, 332.8, 0.5882, 19.90},
                                                       {0.2353, 855.1, 355.1, 0.4925, 20.56},
                                                       {0.2179, 379.5, 78.75, 1.839, 4.645},
                                                       {0.2692, 552.4, 105.3, 3.609, 6.430},
                                                       {0.2041, 769.9, 271.7, 0.7764, 18.06}}};

struct Bench {
  Plant arm;
  std::array<double, 5> guess{};
  MotionScale scale;
  Drive drive;  // whole length, lead-in included
  Drive trial;  // the first 22 s of it, for finding a strength
};

Drive shortened(const Drive& drive, double seconds) {
  Drive d = drive;
  const std::size_t n = std::min(d.force.size(), d.lead_in + static_cast<std::size_t>(seconds / d.sample_time_s));
  d.force.resize(n);
  if (!d.tremor.empty()) d.tremor.resize(n);
  d.equilibrium.clear();
  return d;
}

std::vector<double> after_lead_in(const Drive& d) {
  return {d.force.begin() + static_cast<std::ptrdiff_t>(d.lead_in), d.force.end()};
}

/// Held-out error that the base model is left with, without noise. Negative where the plant diverged.
double structural_error(const Bench& bench, const Plant& plant, const Drive& drive) {
  const std::vector<double> position = run_plant(plant, drive);
  if (position.empty()) return -1;
  return fit_arm(after_lead_in(drive), position, kSampleTime, drive.held, bench.guess).held_out_rms;
}

/// Strength at which the base model's structural error is about `target`, between the recipe's limits.
double find_strength(const Bench& bench, const Recipe& recipe, double target) {
  double lo = recipe.lo, hi = recipe.hi, s = std::sqrt(lo * hi);
  double slope = 1.2, last_s = 0, last_e = 0;
  for (int i = 0; i < 6; ++i) {
    Plant plant = bench.arm;
    recipe.apply(plant, s);
    if (plant.drifts != Plant::Drifts::none) plant.drift_duration = 22, plant.drift_time *= 22.0 / 60;
    const double e = structural_error(bench, plant, bench.trial);
    if (e < 0) {
      hi = 0.75 * s;
      s = std::sqrt(lo * hi);
      continue;
    }
    if (std::abs(std::log(e / target)) < 0.15) break;
    if (last_e > 0 && std::abs(std::log(s / last_s)) > 0.05)
      slope = std::clamp(std::log(e / last_e) / std::log(s / last_s), 0.4, 3.0);
    last_s = s;
    last_e = e;
    const double next = std::clamp(s * std::pow(target / e, 1 / slope), lo, hi);
    if (std::abs(std::log(next / s)) < 0.02) break;
    s = next;
  }
  return std::clamp(s, lo, hi);
}

struct Nuisance {
  double noise = 5e-5, force_noise = 0.01, wander = 0;
  bool moves_the_body = false;  // wander of the point that the arm hangs on, rather than of what is measured
  double floor() const { return std::sqrt(noise * noise + wander * wander + 7.5e-11 /* 0.03 mm quantised */); }
};

Nuisance draw_nuisance(Draw& draw) {
  Nuisance n;
  n.noise = draw.log_uniform(2e-5, 1e-4);
  n.force_noise = draw.uniform(5e-3, 2e-2);
  const double kind = draw.uniform(0, 1);
  n.wander = kind < 0.3 ? 0.0 : kind < 0.75 ? draw.log_uniform(3e-5, 3e-4) : draw.uniform(3e-4, 1e-3);
  n.moves_the_body = draw.chance(0.25);
  return n;
}

/// Records the plant: the run with everything, noise on both channels, quantisation, and the truth about it.
bool record(const Bench& bench, const Plant& plant, const Nuisance& nuisance, Draw& draw, PlantedRecording& out) {
  Drive with = bench.drive;
  const std::size_t count = with.force.size() - with.lead_in;
  const std::vector<double> wander = slow_wander(draw, count, kSampleTime, nuisance.wander);
  const bool body = nuisance.moves_the_body && nuisance.wander > 0;
  if (body) {
    with.equilibrium.assign(with.lead_in, 0.0);
    with.equilibrium.insert(with.equilibrium.end(), wander.begin(), wander.end());
  }
  std::vector<double> moved = run_plant(plant, with);
  if (moved.empty()) return false;
  Plant calm = plant;
  calm.tremor_force = 0;
  out.predictable = body || plant.tremor_force != 0 ? run_plant(calm, bench.drive) : moved;
  if (out.predictable.empty()) return false;
  out.force = after_lead_in(bench.drive);
  out.position.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double x = moved[i] + (body ? 0.0 : wander[i]) + nuisance.noise * draw.normal();
    out.position[i] = quantised(x, 3e-5);
    out.force[i] = quantised(out.force[i] + nuisance.force_noise * draw.normal(), 3e-3);
  }
  const std::size_t held_out = count * 6 / 10;
  out.rmse_floor = rms_difference(out.position, out.predictable, held_out);
  const BaseFit base = fit_arm(out.force, out.position, kSampleTime, bench.drive.held, bench.guess);
  out.rmse_base = base.held_out_rms;
  const char* names[] = {"mass_kg", "k1_N_per_m", "k2_N_per_m", "b1_Ns_per_m", "b2_Ns_per_m"};
  for (std::size_t i = 0; i < 5; ++i) {
    out.base_fit[names[i]] = base.parameters[i];
    out.base_parameters[names[i]] = bench.guess[i];
  }
  out.noise_rms = nuisance.noise;
  out.wander_rms = nuisance.wander;
  out.hold = bench.drive.held ? "held" : "interpolated";
  return true;
}

Bench set_up(Draw& draw, double duration) {
  Bench b;
  b.guess = kArms[static_cast<std::size_t>(draw.pick(12))];
  b.arm.M = b.guess[0];
  b.arm.k1 = b.guess[1];
  b.arm.k2 = b.guess[2];
  b.arm.b1 = b.guess[3];
  b.arm.b2 = b.guess[4];
  b.drive.lead_in = draw.chance(0.5) ? 0 : 1500;
  b.drive.held = draw.chance(0.6);
  const std::size_t count = static_cast<std::size_t>(duration / kSampleTime) + b.drive.lead_in;
  b.drive.force = coloured_force(draw, count, kSampleTime, draw.uniform(1.0, 2.0), 5.0);
  b.trial = shortened(b.drive, 22);
  Plant stiff = b.arm;
  const std::vector<double> grip = run_plant(stiff, b.trial);
  stiff.k1 = 0;  // the force on the mass itself: the arm's own motion
  const std::vector<double> mass = run_plant(stiff, b.trial);
  b.scale.force = rms(b.trial.force);
  b.scale.x = rms(mass);
  b.scale.grasp = rms_difference(grip, mass, 0);
  double sum = 0;
  for (std::size_t i = 1; i < mass.size(); ++i) sum += std::pow((mass[i] - mass[i - 1]) / kSampleTime, 2);
  b.scale.v = std::sqrt(sum / static_cast<double>(mass.size()));
  return b;
}

PlantedRecording plant_on_arm(const std::vector<std::string>& names, std::uint64_t seed, double duration) {
  PlantedRecording best;
  for (std::uint64_t attempt = 0; attempt < 8; ++attempt) {
    Draw draw(seed + 1000003 * attempt);
    Bench bench = set_up(draw, duration);
    Nuisance nuisance = draw_nuisance(draw);
    Plant plant = bench.arm;
    plant.drift_duration = duration;
    PlantedRecording out;
    bool tremor = false;
    double structural = 0;  // of the strongest
    for (const std::string& name : names) {
      Recipe recipe = draw_recipe(name, draw, bench.arm, bench.scale);
      tremor = tremor || recipe.tremor;
      const double ratio = draw.log_uniform(2.3, names.size() > 1 ? 15 : 50);
      double strength = 0;
      if (recipe.tremor) {
        bench.drive.tremor =
            narrow_band(draw, bench.drive.force.size(), kSampleTime, recipe.tremor_Hz, recipe.tremor_bandwidth_Hz);
        Drive silent = shortened(bench.drive, 22);
        std::fill(silent.force.begin(), silent.force.end(), 0.0);
        Plant shaken = bench.arm;
        shaken.tremor_force = 1;
        strength = nuisance.noise * draw.uniform(1.5, 6) / rms(run_plant(shaken, silent));
      } else {
        strength = find_strength(bench, recipe, nuisance.floor() * std::sqrt(ratio * ratio - 1));
        Plant alone = bench.arm;
        recipe.apply(alone, strength);
        if (alone.drifts != Plant::Drifts::none) alone.drift_duration = 22, alone.drift_time *= 22.0 / 60;
        structural = std::max(structural, structural_error(bench, alone, bench.trial));
      }
      recipe.apply(plant, strength);
      out.truth.push_back({name, recipe.variant, recipe.parameters(strength)});
    }
    // where the strongest admissible effect is lost in the wander, the hand was calmer
    while (!names.empty() && !tremor && structural < 1.9 * nuisance.floor() && nuisance.wander > 1e-5)
      nuisance.wander *= 0.6;
    if (!record(bench, plant, nuisance, draw, out)) continue;
    const bool wanted = names.empty() || tremor || (out.ratio() >= 2 && out.ratio() <= 100);
    if (wanted) return out;
    if (best.force.empty() || std::abs(std::log(out.ratio() / 10)) < std::abs(std::log(best.ratio() / 10))) best = out;
  }
  if (best.force.empty()) throw std::runtime_error("no stable plant was found for this seed");
  return best;
}

std::vector<std::string> split(std::string_view text, char separator) {
  std::vector<std::string> parts;
  while (!text.empty()) {
    const std::size_t end = text.find(separator);
    parts.emplace_back(text.substr(0, end));
    text = end == std::string_view::npos ? std::string_view() : text.substr(end + 1);
  }
  return parts;
}

bool contains(const std::vector<std::string>& list, std::string_view word) {
  return std::find(list.begin(), list.end(), word) != list.end();
}

}  // namespace

std::string_view group_name(PlantedGroup group) {
  return std::array{"none", "single", "pair", "outside", "axis"}[static_cast<std::size_t>(group)];
}

std::string PlantedRecording::truth_names() const {
  std::string names;
  for (const PlantedEffect& effect : truth) names += (names.empty() ? "" : ";") + effect.name;
  return names;
}

const std::vector<std::string>& planted_singles() {
  static const std::vector<std::string> names{"coulomb_friction",
                                              "reflex_feedback",
                                              "cubic_stiffness",
                                              "time_delay",
                                              "backlash",
                                              "parameter_drift",
                                              "added_mass",
                                              "flexible_mode",
                                              "hysteresis",
                                              "sensor_lag",
                                              "quadratic_damping",
                                              "position_ripple",
                                              "stribeck_friction",
                                              "viscoelastic_relaxation",
                                              "asymmetric_stiffness",
                                              "tremor",
                                              "offset"};
  return names;
}

const std::vector<std::string>& planted_pairs() {
  static const std::vector<std::string> names{"reflex_feedback+cubic_stiffness",
                                              "coulomb_friction+time_delay",
                                              "backlash+added_mass",
                                              "coulomb_friction+cubic_stiffness",
                                              "reflex_feedback+coulomb_friction",
                                              "parameter_drift+time_delay",
                                              "cubic_stiffness+added_mass",
                                              "quadratic_damping+sensor_lag",
                                              "flexible_mode+coulomb_friction",
                                              "asymmetric_stiffness+time_delay",
                                              "position_ripple+time_delay",
                                              "offset+cubic_stiffness",
                                              "hysteresis+added_mass",
                                              "tremor+coulomb_friction",
                                              "viscoelastic_relaxation+backlash"};
  return names;
}

const std::vector<std::string>& planted_outsiders() {
  static const std::vector<std::string> names{"one_sided_stop",
                                              "abs_x_damping",
                                              "x_squared_damping",
                                              "friction_with_distance",
                                              "arm_freeplay",
                                              "two_sided_stop",
                                              "saturating_force",
                                              "direction_dependent_stiffness",
                                              "speed_dependent_stiffness",
                                              "root_damping"};
  return names;
}

PlantedRecording plant_recording(std::string_view what, std::uint64_t seed, const PlantedOptions& options) {
  if (contains(planted_axes(), what)) return plant_axis(what, seed, options);
  const std::vector<std::string> names = what == "none" ? std::vector<std::string>{} : split(what, '+');
  PlantedRecording recording = plant_on_arm(names, seed, options.duration_s);
  recording.group = names.empty() ? PlantedGroup::none : names.size() > 1 ? PlantedGroup::pair : PlantedGroup::single;
  if (names.size() == 1 && contains(planted_outsiders(), names[0])) {
    recording.group = PlantedGroup::outside;
    recording.catalogued = false;
  }
  return recording;
}

PlantedRecording plant_stratified(std::size_t index, std::uint64_t seed) {
  const std::size_t ten = index / 10, place = index % 10;
  const PlantedOptions options{index % 5 == 4 ? 30.0 : 60.0};
  const std::uint64_t own = seed * 7919 + index * 104729 + 17;
  const auto turn = [](const std::vector<std::string>& list, std::size_t i) { return list[i % list.size()]; };
  switch (place) {
    case 0:
    case 5:
      return plant_recording("none", own, options);
    case 1:
    case 2:
      return plant_recording(turn(planted_singles(), 4 * ten + place - 1), own, options);
    case 6:
    case 7:
      return plant_recording(turn(planted_singles(), 4 * ten + place - 4), own, options);
    case 3:
      return plant_recording(turn(planted_pairs(), 2 * ten), own, options);
    case 8:
      return plant_recording(turn(planted_pairs(), 2 * ten + 1), own, options);
    case 4:
      return plant_recording(turn(planted_outsiders(), ten), own, options);
    default:
      return plant_recording(turn(planted_axes(), ten), own, options);
  }
}

}  // namespace handloop::tests
