/// Speed of sweeps: margins a second through everything (threads, statistics, database), and the time domain against
/// MuJoCo's own loop on the same model and step, taken in turns so that both see the same machine.
#include <benchmark/benchmark.h>
#include <mujoco/mujoco.h>
#include <unistd.h>

#include <chrono>
#include <ctime>
#include <filesystem>
#include <thread>

#include "io/scenario_file.h"
#include "studies/sweep.h"
#include "studies/time_domain.h"

namespace {

using namespace handloop;
using Clock = std::chrono::steady_clock;

/// Processor time of this thread: what is measured is the program, not who else uses the machine.
double thread_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

studies::SweepSettings wall_sweep(std::uint64_t arms) {
  studies::SweepSettings s;
  s.scenario = io::default_scenario();
  s.scenario_name = "bench";
  s.arms = arms;
  s.stiffness = {100, 3000, 16};
  s.damping = {0, 5, 8};
  return s;
}

/// argument 0: threads; argument 1: 1 where a row for every evaluation is kept.
void BM_MarginSweep(benchmark::State& state) {
  studies::SweepSettings settings = wall_sweep(2000);
  settings.keep_evaluations = state.range(1) != 0;
  const auto folder = std::filesystem::temp_directory_path() / ("handloop_bench_sweep_" + std::to_string(::getpid()));
  std::uint64_t evaluations = 0;
  for (auto _ : state) {
    studies::SweepRun run;
    run.out = folder;
    run.jobs = static_cast<int>(state.range(0));
    evaluations += studies::run_sweep(settings, run, {})->evaluations;
  }
  std::filesystem::remove_all(folder);
  state.counters["evaluations_per_s"] =
      benchmark::Counter(static_cast<double>(evaluations), benchmark::Counter::kIsRate);
}
BENCHMARK(BM_MarginSweep)
    ->Args({1, 1})
    ->Args({2, 1})
    ->Args({1, 0})
    ->Args({2, 0})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime()
    ->MeasureProcessCPUTime();

/// The fastest arm-free question there is: how many steps a second the judge makes, and how many mj_step makes.
void BM_TimeDomainAgainstBareMuJoCo(benchmark::State& state) {
  const models::Scenario scenario = studies::still_scenario(io::default_scenario(), models::Axis::z);
  studies::TimeDomainLoop loop(scenario);
  const double steps_per_sample = loop.plant().description().sample_time_s / loop.plant().description().physics_step_s;
  mjModel* model = mj_copyModel(nullptr, loop.plant().mujoco_model());
  model->opt.integrator = mjINT_RK4;
  model->opt.timestep = loop.plant().description().physics_step_s;
  mjData* data = mj_makeData(model);
  mj_resetData(model, data);
  double ours_s = 0, theirs_s = 0, ours = 0, theirs = 0;
  for (auto _ : state) {
    const std::uint64_t before = loop.samples();
    const double a = thread_seconds();
    benchmark::DoNotOptimize(loop.judge(700, 1));
    ours_s += thread_seconds() - a;
    const double steps = static_cast<double>(loop.samples() - before) * steps_per_sample;
    ours += steps;
    const double b = thread_seconds();
    for (double i = 0; i < steps; ++i) mj_step(model, data);
    theirs_s += thread_seconds() - b;
    theirs += steps;
  }
  mj_deleteData(data);
  mj_deleteModel(model);
  state.counters["judge_steps_per_s"] = ours / ours_s;
  state.counters["mj_step_steps_per_s"] = theirs / theirs_s;
  state.counters["ratio"] = (ours / ours_s) / (theirs / theirs_s);
}
BENCHMARK(BM_TimeDomainAgainstBareMuJoCo)->Unit(benchmark::kMillisecond)->UseRealTime();

/// The same work by one thread and then by two.
void BM_TimeDomainOnTwoCores(benchmark::State& state) {
  const models::Scenario scenario = studies::still_scenario(io::default_scenario(), models::Axis::z);
  studies::TimeDomainLoop first(scenario), second(scenario);
  const auto work = [](studies::TimeDomainLoop& loop) {
    for (int i = 0; i < 4; ++i) benchmark::DoNotOptimize(loop.judge(700, 1));
  };
  double alone = 0, together = 0;
  for (auto _ : state) {
    const auto a = Clock::now();
    work(first);
    work(second);
    alone += seconds_since(a);
    const auto b = Clock::now();
    std::thread other([&] { work(second); });
    work(first);
    other.join();
    together += seconds_since(b);
  }
  state.counters["speedup"] = alone / together;
}
BENCHMARK(BM_TimeDomainOnTwoCores)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace

BENCHMARK_MAIN();
