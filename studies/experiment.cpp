#include "studies/experiment.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <exception>
#include <mutex>
#include <numeric>
#include <thread>

#include "device/sim_device.h"
#include "io/output.h"
#include "models/errors.h"
#include "models/random.h"
#include "studies/experiment_report.h"

namespace handloop::studies {
namespace {

using models::CounterRandom;
using models::RandomStream;

/// Seeds of single trials, far from the substreams that order them.
constexpr std::uint32_t kTrialSeeds = 1u << 31;

std::uint64_t trial_seed(std::uint64_t seed, std::size_t number) {
  return CounterRandom(seed, RandomStream::trial_order, kTrialSeeds).bits(number)[0];
}

/// Fisher and Yates.
template <typename T>
void shuffle(std::vector<T>& items, const CounterRandom& random) {
  for (std::size_t i = items.size(); i > 1; --i) {
    const auto other = static_cast<std::size_t>(random.uniform(i) * static_cast<double>(i));
    std::swap(items[i - 1], items[other]);
  }
}

void require_possible(const ExperimentRequest& request) {
  if (!(request.duration_s >= 1.0) || !(request.duration_s <= 3600.0)) {
    throw InputError(fmt::format("a trial of {} s is not possible: 1 to 3600 s", request.duration_s));
  }
  if (request.stimulus_rms_N < 0 || !std::isfinite(request.stimulus_rms_N)) {
    throw InputError("the rms of the stimulus must be a finite number of zero (a third of the cap) or more");
  }
  if (request.arm) {
    if (request.arm->rotary)
      throw InputError("the Phantom's stylus moves along lines: a rotary arm cannot be recorded on it");
    models::require_valid(*request.arm);
    return;
  }
  if (request.subjects == 0 || request.grips_N.empty() || request.axes.empty()) {
    throw InputError("there is nothing to record: give at least one subject, one grip force and one axis");
  }
  for (const int grip : request.grips_N) {
    if (grip < 1 || grip > 3) throw InputError(fmt::format("grip force {} N was not measured: give 1, 2 or 3", grip));
  }
}

double rms(const std::vector<double>& x) {
  const double mean = std::accumulate(x.begin(), x.end(), 0.0) / static_cast<double>(x.size());
  double sum = 0;
  for (const double value : x) sum += (value - mean) * (value - mean);
  return std::sqrt(sum / static_cast<double>(x.size()));
}

std::string file_name(const Trial& trial) {
  return fmt::format("trial_{:03d}.csv", trial.number);
}

std::string index_csv(const ExperimentRequest& request, const std::vector<Trial>& trials,
                      const std::vector<TrialOutcome>& outcomes) {
  std::string text = "trial,subject,grip,axis";
  for (const auto name : models::kArmParameterNames) fmt::format_to(std::back_inserter(text), ",{}", name);
  text += ",file,cap_N,stimulus_rms_N,clipped_samples,repeats,force_rms_N,position_rms_m\n";
  for (std::size_t i = 0; i < trials.size(); ++i) {
    const auto& trial = trials[i];
    const auto& outcome = outcomes[i];
    fmt::format_to(std::back_inserter(text), "{},{},{},{}", trial.number, trial.subject, trial.grip_N,
                   models::axis_name(trial.axis));
    const bool five_parameters = !request.arm || request.arm->base == models::BaseModel::arm5;
    for (const double value : models::to_array(trial.arms[static_cast<std::size_t>(trial.axis)])) {
      text += five_parameters ? fmt::format(",{}", value) : ",";
    }
    fmt::format_to(std::back_inserter(text), ",{},{:.6g},{:.6g},{},{},{:.6g},{:.6g}\n", file_name(trial), outcome.cap_N,
                   outcome.stimulus_rms_N, outcome.clipped_samples, outcome.repeats, outcome.force_rms_N,
                   outcome.position_rms_m);
  }
  return text;
}

}  // namespace

std::vector<Trial> plan_trials(const ExperimentRequest& request) {
  require_possible(request);
  std::array<models::ArmParameters, 3> nominal;
  for (const auto axis : models::kAxes) nominal[static_cast<std::size_t>(axis)] = models::nominal_arm(axis);
  std::vector<Trial> trials;
  if (request.arm) {
    Trial trial;
    trial.grip_N = request.grips_N.size() == 1 ? request.grips_N.front() : 2;
    trial.axis = request.arm->axis;
    trial.arms = nominal;
    trial.arms[static_cast<std::size_t>(trial.axis)] = request.arm->arm;
    trials.push_back(trial);
  } else {
    std::vector<models::ArmPopulation> populations;
    for (const auto axis : models::kAxes) populations.emplace_back(axis, request.percentiles);
    for (std::size_t subject = 1; subject <= request.subjects; ++subject) {
      std::vector<Trial> own;
      for (const int grip : request.grips_N) {
        Trial trial;
        trial.subject = subject;
        trial.grip_N = grip;
        for (const auto axis : models::kAxes) {
          const auto i = static_cast<std::size_t>(axis);
          trial.arms[i] = populations[i].sample(request.seed, 3 * (subject - 1) + static_cast<std::size_t>(grip - 1));
        }
        for (const auto axis : request.axes) {
          trial.axis = axis;
          own.push_back(trial);
        }
      }
      shuffle(own, CounterRandom(request.seed, RandomStream::trial_order, static_cast<std::uint32_t>(subject)));
      trials.insert(trials.end(), own.begin(), own.end());
    }
  }
  for (std::size_t i = 0; i < trials.size(); ++i) {
    trials[i].number = i + 1;
    trials[i].seed = trial_seed(request.seed, i + 1);
  }
  return trials;
}

models::Scenario trial_scenario(const ExperimentRequest& request, const Trial& trial) {
  models::Scenario scenario = request.rig;
  scenario.arm.attached = true;
  scenario.arm.axes = trial.arms;
  scenario.arm.rigid = {};
  scenario.arm.effects.clear();
  scenario.arm.grip_force_N = trial.grip_N;
  if (request.arm) {
    if (request.arm->base == models::BaseModel::msd) {
      scenario.arm.rigid[static_cast<std::size_t>(trial.axis)] = request.arm->msd;
    }
    for (const auto& effect : request.arm->effects) scenario.arm.effects.emplace_back(trial.axis, effect);
  }
  scenario.hand.push_N = scenario.hand.disturbance_N = 0.0;  // the subject holds still
  scenario.run.seed = trial.seed;
  return scenario;
}

ExperimentSummary run_experiment(const ExperimentRequest& request, const std::filesystem::path& directory,
                                 const Progress& progress) {
  const auto begin = std::chrono::steady_clock::now();
  const auto trials = plan_trials(request);
  io::OutputDirectory output(directory);
  std::vector<TrialOutcome> outcomes(trials.size());
  std::atomic<std::size_t> next{0};
  std::mutex reporting;
  std::size_t done = 0;
  std::exception_ptr failure;
  const auto work = [&] {
    for (std::size_t i = next++; i < trials.size(); i = next++) {
      try {
        TrialPlan plan;
        plan.axis = trials[i].axis;
        plan.stimulus = request.stimulus;
        plan.rms_N = request.stimulus_rms_N;
        plan.duration_s = request.duration_s;
        plan.seed = trials[i].seed;
        const auto record = record_trial(
            plan, trial_scenario(request, trials[i]),
            [](const models::Scenario& scenario) { return std::make_unique<device::SimDevice>(scenario); });
        io::write_file_atomically(output / file_name(trials[i]), to_csv(record));
        outcomes[i] = {record.cap_N,        record.stimulus_rms_N,  record.clipped_samples, record.repeats,
                       rms(record.force_N), rms(record.position_m), excerpt(record)};
        const std::lock_guard lock(reporting);
        if (progress) progress(++done, trials.size());
      } catch (...) {
        const std::lock_guard lock(reporting);
        if (!failure) failure = std::current_exception();
        next = trials.size();
      }
    }
  };
  const unsigned cores = std::max(1u, std::thread::hardware_concurrency());
  const auto workers = std::min<std::size_t>(request.jobs == 0 ? cores : request.jobs, trials.size());
  {
    std::vector<std::jthread> pool;
    for (std::size_t i = 1; i < workers; ++i) pool.emplace_back(work);
    work();
  }
  if (failure) std::rethrow_exception(failure);
  io::write_file_atomically(output / "index.csv", index_csv(request, trials, outcomes));
  io::write_file_atomically(output / "report.html", experiment_report(request, trials, outcomes));
  output.commit();
  ExperimentSummary summary;
  summary.trials = trials.size();
  summary.recorded_s = request.duration_s * static_cast<double>(trials.size());
  for (const auto& outcome : outcomes) summary.clipped_samples += outcome.clipped_samples;
  summary.wall_time_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return summary;
}

}  // namespace handloop::studies
