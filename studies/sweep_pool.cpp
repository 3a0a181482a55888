#include "studies/sweep_pool.h"

namespace handloop::studies {

SweepPool::SweepPool(const SweepJudge& judge, int threads, std::uint64_t arms, bool keep_evaluations)
    : judge_(judge), arms_(arms), keep_(keep_evaluations) {
  for (int i = 0; i < threads; ++i) threads_.emplace_back([this] { work(); });
}

SweepPool::~SweepPool() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
    tasks_.clear();
  }
  given_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

void SweepPool::submit(SweepTask task) {
  {
    const std::lock_guard lock(mutex_);
    tasks_.push_back(std::move(task));
  }
  ++outstanding_;
  given_.notify_one();
}

std::optional<SweepBlockResult> SweepPool::collect(std::chrono::milliseconds within) {
  std::unique_lock lock(mutex_);
  finished_.wait_for(lock, within, [&] { return !results_.empty() || failure_; });
  if (failure_) std::rethrow_exception(failure_);
  if (results_.empty()) return std::nullopt;
  SweepBlockResult result = std::move(results_.front());
  results_.pop_front();
  --outstanding_;
  return result;
}

void SweepPool::work() {
  try {
    const std::unique_ptr<SweepJudge::Workspace> workspace = judge_.make_workspace();
    std::vector<double> scratch;
    while (true) {
      SweepTask task;
      {
        std::unique_lock lock(mutex_);
        given_.wait(lock, [&] { return stop_ || !tasks_.empty(); });
        if (stop_) return;
        task = std::move(tasks_.front());
        tasks_.pop_front();
      }
      const auto begin = std::chrono::steady_clock::now();
      SweepBlockResult result;
      result.block = task.block;
      result.evaluations.resize(task.block.evaluations());
      judge_.judge(task.block, task.points, *workspace, result.evaluations);
      if (task.block.arm_count == arms_) {
        scratch.resize(arms_);
        for (std::uint32_t p = 0; p < task.block.point_count; ++p)
          result.statistics.push_back(summarise(std::span(result.evaluations).subspan(p * arms_, arms_), scratch));
        if (!keep_) result.evaluations = {};
      }
      result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
      {
        const std::lock_guard lock(mutex_);
        results_.push_back(std::move(result));
      }
      finished_.notify_one();
    }
  } catch (...) {
    const std::lock_guard lock(mutex_);
    if (!failure_) failure_ = std::current_exception();
    finished_.notify_one();
  }
}

}  // namespace handloop::studies
