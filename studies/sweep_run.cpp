#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <csignal>
#include <set>

#include "control/loop.h"
#include "io/output.h"
#include "models/errors.h"
#include "studies/sweep.h"
#include "studies/sweep_outputs.h"
#include "studies/sweep_ranks.h"
#include "studies/sweep_requirements.h"
#include "studies/sweep_store.h"

namespace handloop::studies {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

/// Evaluations in a block: some hundredths of a second of work, so that little is lost with a process and little is
/// spent on handing out. Part of no result, but a resumed sweep must cut as it did before.
constexpr std::uint64_t kMarginBlock = 4096;
constexpr std::uint64_t kTimeDomainBlock = 8;

volatile std::sig_atomic_t stop_signal = 0;

/// While it lives, SIGINT, SIGTERM and SIGHUP ask the sweep to stop at the next block.
class StopOnSignal {
 public:
  StopOnSignal() {
    stop_signal = 0;
    struct sigaction action {};
    action.sa_handler = [](int number) { stop_signal = number; };
    sigemptyset(&action.sa_mask);
    for (std::size_t i = 0; i < kSignals.size(); ++i) sigaction(kSignals[i], &action, &before_[i]);
  }
  ~StopOnSignal() {
    for (std::size_t i = 0; i < kSignals.size(); ++i) sigaction(kSignals[i], &before_[i], nullptr);
  }
  StopOnSignal(const StopOnSignal&) = delete;
  StopOnSignal& operator=(const StopOnSignal&) = delete;

 private:
  static constexpr std::array<int, 3> kSignals{SIGINT, SIGTERM, SIGHUP};
  std::array<struct sigaction, 3> before_{};
};

void require_valid(const SweepSettings& s) {
  const auto wrong = [](const std::string& what) { throw InputError("sweep: " + what); };
  if (s.scenario.device.model != models::DeviceModel::phantom_premium_1_5) {
    wrong("scenario '" + s.scenario.name +
          "' is of the seven-bar; arms of Table III hold the phantom_premium_1_5 only. "
          "How far alpha may go on the seven-bar says handloop margins --scenario");
  }
  if (s.arms < 1) wrong("--arms must be at least 1");
  if (s.arms > 100'000'000) wrong("--arms must be at most 100000000");
  if (s.devices < 1 || s.devices > 10000) wrong("--devices must be from 1 to 10000");
  if (s.design == SweepDesign::latin_hypercube && (s.points < 1 || s.points > 1'000'000))
    wrong("--points must be from 1 to 1000000");
  if (s.design == SweepDesign::adaptive) {
    if (s.levels < 1 || s.levels > 12) wrong("--levels must be from 1 to 12");
    if (s.stiffness.count < 2 || s.damping.count < 2)
      wrong(
          "an adaptive sweep needs at least two values of each gain to begin with, for example --gains "
          "k=100:3000:5,b=0:5:5");
    if (!(s.boundary > 0 && s.boundary <= 1)) wrong("--boundary must be a share above 0, at most 1");
  }
  for (const int delay : s.delays)
    if (delay < 0 || delay > control::kMaxDelaySamples)
      wrong(fmt::format("a delay must be from 0 to {} samples", control::kMaxDelaySamples));
  if (s.method == SweepMethod::mujoco && !s.keep_evaluations) wrong("the time domain always keeps its evaluations");
}

/// One run of rank 0: makes, hands out, collects and commits.
class Leader {
 public:
  Leader(const SweepSettings& settings, const SweepRun& run, const SweepProgress& progress, SweepRanks& ranks,
         SweepPool& pool, SweepStore& store)
      : settings_(settings), run_(run), progress_(progress), ranks_(ranks), pool_(pool), store_(store) {}

  void execute() {
    const std::vector<SweepCondition> conditions = sweep_conditions(settings_);
    const auto there = store_.committed();
    std::vector<SweepPoint> points;
    std::vector<SweepPoint> added = first_points(settings_, conditions.size());
    for (int stage = 1; !added.empty(); ++stage) {
      const std::size_t from = points.size();
      points.insert(points.end(), added.begin(), added.end());
      if (points.size() > 100'000'000) throw InputError("sweep: more than 100 million points; ask for fewer gains");
      store_.add_points(points);
      const bool whole = settings_.method == SweepMethod::margins;
      std::deque<SweepTask> tasks;
      for (const SweepBlock& block :
           cut_blocks(points, from, settings_.arms, whole ? kMarginBlock : kTimeDomainBlock, whole)) {
        total_ += block.evaluations();
        if (there.contains({block.first_point, block.first_arm})) {
          done_ += block.evaluations();
          continue;
        }
        tasks.push_back(
            {block, {points.begin() + block.first_point, points.begin() + block.first_point + block.point_count}});
      }
      work_off(tasks);
      store_.finish_cells(settings_.arms);
      std::vector<double> shares;
      if (settings_.design == SweepDesign::adaptive)
        for (const PointStatistics& cell : store_.cells()) shares.push_back(cell.p_stable());
      added = next_points(settings_, conditions.size(), points, shares, stage);
    }
    show_progress(true);
  }

  std::uint64_t evaluated_now() const { return now_; }

 private:
  void work_off(std::deque<SweepTask>& tasks) {
    while (!tasks.empty() || pool_.outstanding() > 0 || ranks_.outstanding() > 0) {
      if (stop_signal != 0) interrupted();
      while (!tasks.empty() && pool_.outstanding() < static_cast<std::size_t>(pool_.threads()) + 1) {
        pool_.submit(std::move(tasks.front()));
        tasks.pop_front();
      }
      while (!tasks.empty() && ranks_.somebody_waits()) {
        ranks_.give(tasks.front());
        tasks.pop_front();
      }
      if (auto result = pool_.collect(std::chrono::milliseconds(ranks_.size() > 1 ? 1 : 50))) commit(*result);
      std::vector<SweepBlockResult> arrived;
      ranks_.poll(arrived);
      for (const SweepBlockResult& result : arrived) commit(result);
      std::string report;
      for (SweepTask& task : ranks_.reclaim(report)) tasks.push_back(std::move(task));
      if (!report.empty()) {
        store_.log_event(report);
        if (!run_.quiet) fmt::print(stderr, "handloop: sweep: {}\n", report);
      }
      show_progress(false);
    }
  }

  void commit(const SweepBlockResult& result) {
    store_.commit(result);
    done_ += result.block.evaluations();
    now_ += result.block.evaluations();
  }

  [[noreturn]] void interrupted() {
    const std::string away = ranks_.whereabouts();
    store_.log_event(
        fmt::format("stopped by signal {}{}{}", int{stop_signal}, away.empty() ? "" : "; lost with it: ", away));
    throw RequirementError(
        fmt::format("sweep: stopped by signal {}; {} of {} evaluations are kept, continue with --resume{}{}",
                    int{stop_signal}, done_, total_, away.empty() ? "" : "; under way were ", away));
  }

  void show_progress(bool last) {
    const Clock::time_point now = Clock::now();
    if (!progress_ || (!last && now - shown_ < std::chrono::milliseconds(200))) return;
    shown_ = now;
    progress_(done_, total_, std::chrono::duration<double>(now - began_).count());
  }

  const SweepSettings& settings_;
  const SweepRun& run_;
  const SweepProgress& progress_;
  SweepRanks& ranks_;
  SweepPool& pool_;
  SweepStore& store_;
  std::uint64_t total_ = 0, done_ = 0, now_ = 0;
  Clock::time_point began_ = Clock::now(), shown_ = began_;
};

/// Where the results of this run are to be: an unfinished database to go on with, a new one, or (false) a finished one
/// that has them all.
bool needs_work(const fs::path& part, const fs::path& finished, const SweepRun& run) {
  if (fs::exists(part)) {
    if (!run.resume)
      throw InputError(part.string() +
                       ": an unfinished sweep; continue it with --resume, or remove the file to begin anew");
    return true;
  }
  return !(run.resume && fs::exists(finished));
}

void write_outputs(const SweepSettings& settings, const SweepRun& run, SweepOutcome& outcome) {
  SweepStore store = SweepStore::read(run.out / "sweep.sqlite");
  SweepContents contents{settings, store.conditions(), store.points(), store.cells(), {}, std::nullopt};
  for (const std::string& expression : run.requirements)
    contents.requirements.push_back(
        check_requirement(parse_requirement(expression), contents.conditions, contents.points, contents.cells));
  if (run.compare_with) {
    SweepStore old_sweep = SweepStore::read(sweep_database_path(*run.compare_with));
    contents.comparison = compare_sweeps(old_sweep, store);
    outcome.comparison = contents.comparison->text();
    outcome.regression = contents.comparison->regressions() > 0;
    if (run.fail_on_regression)
      contents.requirements.push_back(
          {"no regression", !outcome.regression,
           fmt::format("significantly fewer stable arms at {} of {} points", contents.comparison->regressions(),
                       contents.comparison->changes.size())});
  }
  for (const PointStatistics& cell : contents.cells) outcome.evaluations += cell.arms;
  outcome.points = contents.points.size();
  outcome.requirements = contents.requirements;
  io::write_file_atomically(run.out / "summary.json", sweep_summary_json(contents));
  io::write_file_atomically(run.out / "junit.xml", sweep_junit_xml(contents));
  io::write_file_atomically(run.out / "report.html", sweep_report_html(contents));
}

}  // namespace

bool SweepOutcome::requirements_met() const {
  return std::all_of(requirements.begin(), requirements.end(), [](const RequirementOutcome& r) { return r.met; });
}

std::optional<SweepOutcome> run_sweep(const SweepSettings& settings, const SweepRun& run,
                                      const SweepProgress& progress) {
  require_valid(settings);
  for (const std::string& expression : run.requirements) {  // what is asked wrongly is said now rather than at the end
    const Requirement requirement = parse_requirement(expression);
    if (settings.design != SweepDesign::adaptive) require_place(requirement, first_points(settings, 1));
  }
  if (run.compare_with) SweepStore::read(sweep_database_path(*run.compare_with));
  SweepRanks ranks;
  const int hardware = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  const int jobs = run.jobs > 0 ? run.jobs : ranks.size() > 1 ? 1 : hardware;
  if (ranks.rank() > 0) {
    try {
      const std::unique_ptr<SweepJudge> judge = make_sweep_judge(settings);
      SweepPool pool(*judge, jobs, settings.arms, settings.keep_evaluations);
      ranks.serve(pool);
    } catch (const std::exception& error) {
      ranks.report_failure(error.what());
    }
    return std::nullopt;
  }

  const StopOnSignal guard;
  const Clock::time_point began = Clock::now();
  const std::unique_ptr<SweepJudge> judge = make_sweep_judge(settings);
  const fs::path part = run.out / "sweep.sqlite.part", finished = run.out / "sweep.sqlite";
  SweepOutcome outcome;
  if (needs_work(part, finished, run)) {
    std::error_code error;
    fs::create_directories(run.out, error);
    if (error) throw InputError(run.out.string() + ": cannot be made: " + error.message());
    const bool begun = fs::exists(part);
    SweepStore store = begun ? SweepStore::resume(part, settings) : SweepStore::create(part, settings);
    store.begin_session(jobs, ranks.size());
    {
      SweepPool pool(*judge, jobs, settings.arms, settings.keep_evaluations);
      Leader leader(settings, run, progress, ranks, pool, store);
      leader.execute();
      outcome.evaluated_now = leader.evaluated_now();
    }
    store.end_session(outcome.evaluated_now, std::chrono::duration<double>(Clock::now() - began).count());
    store.settle();
    fs::rename(part, finished, error);
    if (error) throw InputError(finished.string() + ": cannot be written: " + error.message());
  } else {
    SweepStore::read(finished).require_same(settings);  // then only what is made of it is made again
  }
  write_outputs(settings, run, outcome);
  outcome.seconds = std::chrono::duration<double>(Clock::now() - began).count();
  return outcome;
}

std::unique_ptr<SweepJudge> make_sweep_judge(const SweepSettings& settings) {
  return settings.method == SweepMethod::margins ? make_margin_judge(settings) : make_time_domain_judge(settings);
}

}  // namespace handloop::studies
