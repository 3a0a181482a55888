#pragma once

#include <chrono>
#include <condition_variable>
#include <deque>
#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "studies/sweep_judge.h"
#include "studies/sweep_store.h"

namespace handloop::studies {

/// A block with the points it is about: all that a thread or another machine needs to know.
struct SweepTask {
  SweepBlock block;
  std::vector<SweepPoint> points;
};

/// Threads that judge blocks. Submitted from and collected by one thread.
class SweepPool {
 public:
  /// `keep_evaluations`: results carry them; statistics are made of every block that holds all `arms`.
  SweepPool(const SweepJudge& judge, int threads, std::uint64_t arms, bool keep_evaluations);
  ~SweepPool();
  SweepPool(const SweepPool&) = delete;
  SweepPool& operator=(const SweepPool&) = delete;

  int threads() const { return static_cast<int>(threads_.size()); }
  void submit(SweepTask task);
  /// Submitted and not yet collected.
  std::size_t outstanding() const { return outstanding_; }
  /// A finished block, or nothing within the time. Rethrows what a judge threw.
  std::optional<SweepBlockResult> collect(std::chrono::milliseconds within);

 private:
  void work();

  const SweepJudge& judge_;
  std::uint64_t arms_;
  bool keep_;
  std::size_t outstanding_ = 0;
  std::mutex mutex_;
  std::condition_variable given_, finished_;
  std::deque<SweepTask> tasks_;
  std::deque<SweepBlockResult> results_;
  std::exception_ptr failure_;
  bool stop_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace handloop::studies
