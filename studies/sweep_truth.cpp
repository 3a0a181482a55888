#include "studies/sweep_truth.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <exception>
#include <mutex>
#include <thread>

#include "control/margins.h"
#include "control/stability_boundary.h"
#include "models/errors.h"
#include "models/random.h"
#include "models/scenario_tip.h"
#include "studies/sweep_plan.h"
#include "studies/time_domain.h"

namespace handloop::studies {
namespace {

using Switch = void (*)(models::Scenario&);

void no_quantisation(models::Scenario& s) {
  s.electronics.encoder_counts_per_rev = 1 << 28;
  s.electronics.dac_bits = s.electronics.adc_bits = 30;
}
void no_saturation(models::Scenario& s) {
  // a wider converter with codes as fine as before
  s.electronics.dac_bits = std::min(30, s.electronics.dac_bits + 4);
  s.electronics.dac_range_V *= 16;
  s.electronics.current_limit_A = 1000;
}
void no_friction(models::Scenario& s) {
  s.device.joint_coulomb_Nm = 0;
}

constexpr struct {
  const char* name;
  Switch off;
} kCauses[] = {{"quantisation", no_quantisation}, {"saturation", no_saturation}, {"friction", no_friction}};

TruthCase judge_case(const SweepSettings& settings, const std::vector<SweepCondition>& conditions,
                     std::uint64_t number) {
  const SweepCondition& condition = conditions[number % conditions.size()];
  const models::ArmPopulation population(condition.axis, settings.percentiles);
  const models::CounterRandom random(settings.seed, models::RandomStream::gain_point, 0x2000);
  TruthCase c;
  c.number = number;
  c.axis = condition.axis;
  models::Scenario scenario = still_scenario(settings.scenario, c.axis);
  scenario.loop.delay_samples = condition.delay_samples;
  scenario.arm.attached = true;
  const models::ScenarioTip tip = models::tip_of(scenario, c.axis);
  const control::LoopTiming timing{scenario.loop.sample_time_s, scenario.loop.delay_samples, scenario.loop.cutoff_Hz};
  // some arms have no stable wall at a damping: draw again until one does
  control::SampledPlant plant;
  double critical = 0;
  for (std::uint64_t draw = 0; draw < 50 && !(critical > 0 && std::isfinite(critical)); ++draw) {
    const auto u = random.uniforms(number, draw);
    models::ArmParameters& arm = scenario.arm.axes[static_cast<std::size_t>(c.axis)];
    arm = population.sample(settings.seed, number + draw * 1'000'003);
    plant = control::sample_plant({tip.mass_kg, tip.damping_Ns_per_m, arm}, timing.sample_time_s);
    c.damping_Ns_per_m = settings.damping.at_share(u[0]);
    critical = control::critical_stiffness(plant, timing, c.damping_Ns_per_m);
    const double width = u[2] < 0.5 ? 0.05 : 0.25;
    c.share_of_critical = 1 + width * (2 * u[1] - 1);
  }
  c.stiffness_N_per_m = c.share_of_critical * critical;
  const control::Margins margins = control::evaluate(plant, timing, {c.stiffness_N_per_m, c.damping_Ns_per_m});
  c.rho = margins.rho;
  c.linear_stable = margins.stable;
  const auto stable = [&](const models::Scenario& s) {
    return TimeDomainLoop(s).judge(c.stiffness_N_per_m, c.damping_Ns_per_m).stable;
  };
  c.simulated_stable = stable(scenario);
  models::Scenario ideal = scenario;
  ideal.electronics.ideal = true;
  no_friction(ideal);
  c.ideal_stable = stable(ideal);
  if (!c.agrees())
    for (const auto& cause : kCauses) {
      models::Scenario without = scenario;
      cause.off(without);
      if (stable(without) == c.linear_stable)
        c.explained_by += (c.explained_by.empty() ? "" : "+") + std::string(cause.name);
    }
  return c;
}

}  // namespace

std::size_t TruthCheck::agreeing() const {
  return static_cast<std::size_t>(
      std::count_if(cases.begin(), cases.end(), [](const TruthCase& c) { return c.agrees(); }));
}
std::size_t TruthCheck::agreeing_ideal() const {
  return static_cast<std::size_t>(
      std::count_if(cases.begin(), cases.end(), [](const TruthCase& c) { return c.ideal_stable == c.linear_stable; }));
}
std::size_t TruthCheck::unexplained() const {
  return static_cast<std::size_t>(std::count_if(cases.begin(), cases.end(), [](const TruthCase& c) {
    return !c.agrees() && c.explained_by.empty() && c.ideal_stable != c.linear_stable;
  }));
}

std::string TruthCheck::text() const {
  std::string text = fmt::format(
      "{} arm and gain points near the boundary: the simulation agrees with the linear loop on {} ({:.1f} %), with "
      "ideal electronics and no "
      "friction on {} ({:.1f} %)\n",
      cases.size(), agreeing(), 100.0 * static_cast<double>(agreeing()) / static_cast<double>(cases.size()),
      agreeing_ideal(), 100.0 * static_cast<double>(agreeing_ideal()) / static_cast<double>(cases.size()));
  for (const TruthCase& c : cases) {
    if (c.agrees()) continue;
    const std::string why = !c.explained_by.empty() ? "agrees without " + c.explained_by
                            : c.ideal_stable == c.linear_stable
                                ? "agrees only with all of quantisation, saturation and friction off"
                                : "not explained";
    text += fmt::format(
        "  case {}: axis {}, k = {:.6g} N/m ({:.1f} % of critical), b = {:.3g} Ns/m, rho = {:.6f}: linear {}, "
        "simulated {}; {}\n",
        c.number, models::axis_name(c.axis), c.stiffness_N_per_m, 100 * c.share_of_critical, c.damping_Ns_per_m, c.rho,
        c.linear_stable ? "stable" : "unstable", c.simulated_stable ? "stable" : "unstable", why);
  }
  return text;
}

std::string TruthCheck::csv() const {
  std::string text =
      "case,axis,stiffness_N_per_m,damping_Ns_per_m,share_of_critical,rho,linear_stable,simulated_stable,ideal_stable,"
      "explained_by\n";
  for (const TruthCase& c : cases)
    text += fmt::format("{},{},{:.10g},{:.10g},{:.6f},{:.9f},{:d},{:d},{:d},{}\n", c.number, models::axis_name(c.axis),
                        c.stiffness_N_per_m, c.damping_Ns_per_m, c.share_of_critical, c.rho, c.linear_stable,
                        c.simulated_stable, c.ideal_stable, c.explained_by);
  return text;
}

TruthCheck check_truth(const SweepSettings& settings, std::uint64_t count, int jobs, const SweepProgress& progress) {
  const std::vector<SweepCondition> conditions = sweep_conditions(settings);
  TruthCheck check;
  check.cases.resize(count);
  std::atomic<std::uint64_t> next{0}, done{0};
  std::exception_ptr failure;
  std::mutex mutex;
  const auto began = std::chrono::steady_clock::now();
  const auto work = [&] {
    try {
      for (std::uint64_t i; (i = next++) < count;) {
        check.cases[i] = judge_case(settings, conditions, i);
        const std::uint64_t finished = ++done;
        const std::lock_guard lock(mutex);
        if (progress)
          progress(finished, count, std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count());
      }
    } catch (...) {
      const std::lock_guard lock(mutex);
      failure = std::current_exception();
      next = count;
    }
  };
  const int threads = jobs > 0 ? jobs : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  std::vector<std::thread> pool;
  for (int i = 0; i < threads; ++i) pool.emplace_back(work);
  for (std::thread& thread : pool) thread.join();
  if (failure) std::rethrow_exception(failure);
  return check;
}

}  // namespace handloop::studies
