#pragma once

#include <chrono>
#include <deque>
#include <map>
#include <string>
#include <vector>

#include "studies/sweep_pool.h"

namespace handloop::studies {

/// Rank of this process where a launcher (mpirun, srun) started it as one of several, without touching MPI; -1
/// elsewhere.
int launched_rank();

/// The ranks of one sweep, over MPI where a launcher started this process, otherwise one rank and no MPI at all.
/// Rank 0 hands out blocks one by one to whoever asks and takes back the results; nobody waits for the slowest but at
/// the end of a stage. A rank that has been silent for long is given up and its blocks are handed out again.
class SweepRanks {
 public:
  SweepRanks();
  ~SweepRanks();
  SweepRanks(const SweepRanks&) = delete;
  SweepRanks& operator=(const SweepRanks&) = delete;

  int rank() const { return rank_; }
  int size() const { return size_; }

  // ---- rank 0 ------------------------------------------------------------------------------------------------------
  /// Takes every message that has arrived; results are appended. Throws InputError with the words of a rank that
  /// failed.
  void poll(std::vector<SweepBlockResult>& results);
  /// Whether another rank is waiting for work.
  bool somebody_waits() const { return !waiting_.empty(); }
  /// Gives a task to the rank that has waited longest.
  void give(const SweepTask& task);
  /// Blocks that are with other ranks.
  std::size_t outstanding() const;
  /// Tasks of ranks that have been silent too long, to be handed out again; `report` says who.
  std::vector<SweepTask> reclaim(std::string& report);
  /// "rank 2: points 12-15; ..." of what is with other ranks now.
  std::string whereabouts() const;

  // ---- other ranks -------------------------------------------------------------------------------------------------
  /// Judges what rank 0 hands out until it says stop.
  void serve(SweepPool& pool);
  /// Tells rank 0 why this rank cannot work.
  void report_failure(const std::string& what);

 private:
  using Clock = std::chrono::steady_clock;
  struct Given {
    SweepTask task;
    int rank = 0;
  };

  bool active_ = false;
  int rank_ = 0, size_ = 1;
  std::deque<int> waiting_;
  std::map<std::pair<std::uint32_t, std::uint64_t>, Given> given_;
  std::vector<Clock::time_point> last_heard_;
  std::vector<bool> dead_;
};

}  // namespace handloop::studies
