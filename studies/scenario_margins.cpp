#include "studies/scenario_margins.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <cmath>
#include <functional>
#include <numbers>

#include "control/stability_boundary.h"
#include "models/arm_tables.h"
#include "models/phantom.h"
#include "models/transducers.h"
#include "studies/scenario_loop.h"

namespace handloop::studies {
namespace {

using control::Loop;
using models::Axis;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

std::size_t index(Axis axis) {
  return static_cast<std::size_t>(axis);
}

/// Margins of an axis with whatever holds it.
control::Margins margins_of(const models::Scenario& scenario, Axis axis) {
  const Loop loop = loop_of(scenario, axis);
  if (!needs_linear_plant(scenario, axis)) return control::evaluate(loop);
  return control::evaluate(hand_model(scenario, axis), {}, loop.plant.tip_mass_kg, loop.plant.tip_damping_Ns_per_m,
                           loop.timing, loop.gains);
}

control::MultiAxisMargins all_axes(const models::Scenario& scenario, const Loop& loop) {
  const Eigen::Vector3d q(scenario.device.pose_rad[0], scenario.device.pose_rad[1], scenario.device.pose_rad[2]);
  const auto phantom = models::phantom_parameters(scenario.device.parameter_set, scenario.device.stylus_mass_kg);
  const Eigen::Matrix3d J = models::phantom_jacobian(phantom, q);
  const Eigen::Matrix3d inertia = models::phantom_tip_mobility(phantom, q).inverse();
  const Eigen::Matrix3d damping = scenario.device.joint_viscous_Nms_per_rad * (J * J.transpose()).inverse();
  control::MultiAxisPlant plant;
  for (const Axis a : models::kAxes) {
    for (const Axis b : models::kAxes) {
      const auto i = static_cast<Eigen::Index>(a), k = static_cast<Eigen::Index>(b);
      plant.tip_inertia_kg(i, k) = inertia(models::device_row(a), models::device_row(b));
      plant.tip_damping_Ns_per_m(i, k) = damping(models::device_row(a), models::device_row(b));
    }
    if (scenario.arm.attached && !scenario.arm.rigid[index(a)]) plant.arms[index(a)] = scenario.arm.axes[index(a)];
  }
  plant.tip_inertia_kg = 0.5 * (plant.tip_inertia_kg + plant.tip_inertia_kg.transpose()).eval();
  return control::evaluate(plant, loop.timing, {loop.gains, loop.gains, loop.gains});
}

UnstructuredResult unstructured(const Loop& loop, const models::UncertaintyModel& W, bool stable) {
  UnstructuredResult r;
  r.narrow = control::unstructured_peak(loop.plant, loop.timing, loop.gains, W, 0.6, 30);
  r.wide = control::unstructured_peak(loop.plant, loop.timing, loop.gains, W, 0.01, 400);
  r.robust = stable && r.narrow.peak < 1;
  r.robust_wide = stable && r.wide.peak < 1;
  return r;
}

/// Largest K up to `limit` at which a test holds, looked for downwards on a logarithmic grid and then sharpened; 0
/// where it holds nowhere above 1 N/m.
double largest_stiffness(double limit, const std::function<bool(double)>& holds) {
  if (!(limit > 1)) return 0;
  double above = limit;
  for (double K = limit * (1 - 1e-9);; K /= 1.25) {
    if (K < 1) K = 1;
    if (holds(K)) {
      double low = K, high = above;
      for (int i = 0; i < 9; ++i) {
        const double middle = 0.5 * (low + high);
        (holds(middle) ? low : high) = middle;
      }
      return low;
    }
    if (K <= 1) return 0;
    above = K;
  }
}

/// Coulomb friction and encoder resolution of the joints, at the tip along an axis, the other axes held.
void tip_friction(const models::Scenario& scenario, Axis axis, ScenarioMargins& result) {
  const Eigen::Vector3d q(scenario.device.pose_rad[0], scenario.device.pose_rad[1], scenario.device.pose_rad[2]);
  const auto phantom = models::phantom_parameters(scenario.device.parameter_set, scenario.device.stylus_mass_kg);
  const Eigen::Matrix3d J = models::phantom_jacobian(phantom, q);
  const Eigen::Vector3d rates = J.inverse().col(models::device_row(axis));  // joint rates for 1 m/s along the axis
  result.coulomb_N = scenario.device.joint_coulomb_Nm * rates.cwiseAbs().sum();
  if (scenario.electronics.ideal) return;
  for (int i = 0; i < 3; ++i) {
    const double joint_step = 2 * std::numbers::pi / scenario.electronics.encoder_counts_per_rev /
                              models::PhantomDrive{}.ratio[static_cast<std::size_t>(i)];
    result.resolution_m += std::abs(J(models::device_row(axis), i)) * joint_step;
  }
}

void fill_permitted(ScenarioMargins& r, const ScenarioMarginsRequest& request,
                    const models::ArmPopulation& population) {
  const auto& loop = r.loop;
  const double B = loop.gains.damping_Ns_per_m, K = loop.gains.stiffness_N_per_m;
  const bool search = request.permitted_stiffness;
  const auto with = [&](double stiffness) { return control::WallGains{stiffness, B}; };
  const auto add = [&](std::string key, std::string test, std::string assumes, std::optional<bool> holds,
                       double stiffness) {
    r.permitted.push_back({std::move(key), std::move(test), std::move(assumes), holds, stiffness});
  };
  const double limit = std::isnan(r.critical_stiffness_N_per_m) ? 0.0 : std::min(r.critical_stiffness_N_per_m, 1e6);
  add("nominal", "Nominal loop, exact poles", "this one arm, linear, bilateral wall", r.nominal.stable,
      r.critical_stiffness_N_per_m);
  if (loop.plant.arm) {
    for (const double share : {0.50, 0.95}) {
      const double stiffness = search ? control::population_permitted_stiffness(population, loop, request.arms,
                                                                                request.seed, share, request.jobs)
                                      : kNone;
      add(fmt::format("population_{:.0f}", 100 * share),
          fmt::format("{:.0f} % of {} sampled arms", 100 * share, request.arms),
          fmt::format("Table III's population, parameters independent, percentiles read as {}",
                      models::percentile_reading_name(request.percentiles)),
          r.population->stable.estimate >= share, stiffness);
    }
    const auto boxed = [&](const char* key, const char* name, control::BoxSet set,
                           const std::optional<control::StructuredMu>& mu) {
      const auto box = control::published_box(r.axis, set);
      control::LoopPlant centre = loop.plant;
      centre.arm = box.centre();
      const double most =
          search ? std::min(1e6, control::critical_stiffness(control::sample_plant(centre, loop.timing.sample_time_s),
                                                             loop.timing, B))
                 : 0.0;
      const auto search_with = [&](auto&& test) {
        return search ? largest_stiffness(most, [&](double k) { return test(loop.plant, loop.timing, with(k), box); })
                      : kNone;
      };
      const auto proof = [](const auto&... a) { return control::certify(a...).certified; };
      add(std::string("structured_") + key, fmt::format("Every arm of the {} box, proof", name),
          "any five parameters within the box, however combined; sampling exact", mu->upper < 1, search_with(proof));
      add(std::string("mapping_") + key, fmt::format("Mapping theorem, {} box", name),
          "convex hull of 32 corners in the place of the value set; sampling's images left out",
          control::mapping_theorem_certifies(loop.plant, loop.timing, loop.gains, box),
          search_with([](const auto&... a) { return control::mapping_theorem_certifies(a...); }));
      add(std::string("kharitonov_") + key, fmt::format("Kharitonov, {} box", name),
          "not the loop itself: delay by Pade, every coefficient free (they are products of parameters)",
          control::kharitonov_certifies(loop.plant, loop.timing, loop.gains, box),
          search_with([](const auto&... a) { return control::kharitonov_certifies(a...); }));
    };
    boxed("67", "67 %", control::BoxSet::percent67, r.mu67);
    boxed("95", "95 %", control::BoxSet::percent95, r.mu95);
    boxed("extremes", "min to max", control::BoxSet::extremes, r.mu_extremes);
    const auto unstructured_row = [&](const char* key, const char* name, models::UncertaintySet set,
                                      const UnstructuredResult& found) {
      const auto& W = models::uncertainty(r.axis, set);
      add(std::string("unstructured_") + key, fmt::format("|W_u T| < 1, {}", name),
          "any stable dynamics within |W_u| of the nominal arm, 0.6 to 30 Hz; sampling's images left out", found.robust,
          search ? largest_stiffness(
                       limit,
                       [&](double k) {
                         return control::unstructured_peak(loop.plant, loop.timing, with(k), W, 0.6, 30).peak < 1;
                       })
                 : kNone);
    };
    unstructured_row("67", "67 % envelope", models::UncertaintySet::percentile67, *r.percentile67);
    unstructured_row("max", "maximum envelope", models::UncertaintySet::maximum, *r.maximum);
    const double hand = loop.plant.arm->b1_Ns_per_m + r.device_damping_Ns_per_m;
    const double rule = control::gil_stiffness(loop.timing, B, hand);
    add("gil_rule", "(b + b1 + B)/(T/2 + dT)",
        "linear rule of Gil et al. with the hand's damping; an approximation, no guarantee", K < rule, rule);
  }
  const double colgate = control::colgate_permitted_stiffness(loop.timing, B, r.device_damping_Ns_per_m);
  add("colgate", "Colgate and Schenkel, with delay", "any passive hand at all; device damping only, no friction",
      r.required_damping_Ns_per_m <= r.device_damping_Ns_per_m, std::isnan(colgate) ? 0.0 : colgate);
  const double llewellyn = control::llewellyn_permitted_stiffness(loop.timing, B, r.device_damping_Ns_per_m);
  add("llewellyn", "Llewellyn, two-port", "any passive hand and any passive virtual world behind the wall",
      r.llewellyn.absolutely_stable(), llewellyn);
  add("abbott_okamura", "Abbott and Okamura, with delay",
      "any hand; Coulomb friction against the encoder's steps; B = 0", K <= r.abbott_okamura.permitted(),
      r.abbott_okamura.permitted());
}

}  // namespace

control::MultiAxisMargins multi_axis_margins(const models::Scenario& scenario) {
  return all_axes(scenario, loop_of(scenario, scenario.wall.axis));
}

ScenarioMargins scenario_margins(const models::Scenario& scenario, const ScenarioMarginsRequest& request,
                                 const Progress& progress) {
  constexpr std::size_t kSteps = 8;
  std::size_t step = 0;
  const auto advance = [&] {
    if (progress) progress(++step, kSteps);
  };
  ScenarioMargins r;
  r.scenario = scenario;
  r.axis = scenario.wall.axis;
  r.loop = loop_of(scenario, r.axis);
  control::require_valid(r.loop);
  const auto model = hand_model(scenario, r.axis);
  r.has_effects = scenario.arm.attached && !model.effects.empty();
  r.nominal = margins_of(scenario, r.axis);
  if (r.has_effects) {
    auto plain = model;
    plain.effects.clear();
    r.without_effects = control::evaluate(plain, {}, r.loop.plant.tip_mass_kg, r.loop.plant.tip_damping_Ns_per_m,
                                          r.loop.timing, r.loop.gains);
  }
  for (const Axis axis : models::kAxes) r.by_axis[index(axis)] = margins_of(scenario, axis);
  advance();
  r.all_axes = all_axes(scenario, r.loop);
  advance();
  const bool rigid = scenario.arm.attached && scenario.arm.rigid[index(r.axis)];
  if (!rigid && r.loop.timing.delay_samples <= control::ClosedLoopVerdict::kMaxDelay) {
    r.critical_stiffness_N_per_m = control::critical_stiffness(
        control::sample_plant(r.loop.plant, r.loop.timing.sample_time_s), r.loop.timing, r.loop.gains.damping_Ns_per_m);
  } else {
    r.critical_stiffness_N_per_m = kNone;
  }
  const auto plain_margins = control::evaluate(r.loop);
  r.ray_limit = r.nominal.stable ? r.nominal.gain_up : kNone;

  r.device_damping_Ns_per_m = r.loop.plant.tip_damping_Ns_per_m;
  tip_friction(scenario, r.axis, r);
  const auto& timing = r.loop.timing;
  auto prompt = timing;
  prompt.delay_samples = 0;
  r.required_damping_Ns_per_m = control::colgate_required_damping(timing, r.loop.gains);
  r.required_damping_no_delay_Ns_per_m = control::colgate_required_damping(prompt, r.loop.gains);
  r.abbott_okamura = control::abbott_okamura(timing, r.device_damping_Ns_per_m, r.coulomb_N, r.resolution_m);
  r.diolaiti =
      control::diolaiti(timing, r.loop.gains.stiffness_N_per_m, r.device_damping_Ns_per_m, r.coulomb_N, r.resolution_m);
  r.llewellyn = control::llewellyn(timing, r.loop.gains, r.device_damping_Ns_per_m);
  advance();
  const models::ArmPopulation population(r.axis, request.percentiles);
  if (r.loop.plant.arm) {
    r.maximum =
        unstructured(r.loop, models::uncertainty(r.axis, models::UncertaintySet::maximum), plain_margins.stable);
    r.percentile67 =
        unstructured(r.loop, models::uncertainty(r.axis, models::UncertaintySet::percentile67), plain_margins.stable);
    advance();
    const auto mu = [&](control::BoxSet set) {
      return control::structured_mu(r.loop.plant, timing, r.loop.gains, control::published_box(r.axis, set));
    };
    r.mu67 = mu(control::BoxSet::percent67);
    r.mu95 = mu(control::BoxSet::percent95);
    r.mu_extremes = mu(control::BoxSet::extremes);
    advance();
    r.population = control::population_margins(population, r.loop, request.arms, request.seed, 5, request.jobs);
    advance();
  }
  fill_permitted(r, request, population);
  if (progress) progress(kSteps, kSteps);
  return r;
}

}  // namespace handloop::studies
