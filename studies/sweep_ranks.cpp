#include "studies/sweep_ranks.h"

#define OMPI_SKIP_MPICXX 1
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wold-style-cast"  // macros of mpi.h
#include <mpi.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <thread>

#include "models/errors.h"

namespace handloop::studies {
namespace {

enum Tag : int { kRequest = 1, kTask, kResult, kStop, kAlive, kFailure };

constexpr auto kHeartbeat = std::chrono::seconds(1);
constexpr auto kSilence = std::chrono::seconds(20);

/// Plain values one after another; all ranks are the same kind of machine.
class Packet {
 public:
  Packet() = default;
  explicit Packet(std::vector<char> bytes) : bytes_(std::move(bytes)) {}

  template <class T>
  Packet& put(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    const auto* from = reinterpret_cast<const char*>(&value);
    bytes_.insert(bytes_.end(), from, from + sizeof value);
    return *this;
  }
  template <class T>
  Packet& put_all(const std::vector<T>& values) {
    put(values.size());
    const auto* from = reinterpret_cast<const char*>(values.data());
    bytes_.insert(bytes_.end(), from, from + values.size() * sizeof(T));
    return *this;
  }
  template <class T>
  T take() {
    T value;
    copy(&value, sizeof value);
    return value;
  }
  template <class T>
  std::vector<T> take_all() {
    const auto count = take<std::size_t>();
    if (count > (bytes_.size() - at_) / sizeof(T)) throw InputError("sweep: a message between ranks is damaged");
    std::vector<T> values(count);
    copy(values.data(), count * sizeof(T));
    return values;
  }
  void send(int rank, int tag) const {
    MPI_Send(bytes_.data(), static_cast<int>(bytes_.size()), MPI_BYTE, rank, tag, MPI_COMM_WORLD);
  }
  static Packet receive(const MPI_Status& status) {
    int size = 0;
    MPI_Get_count(&status, MPI_BYTE, &size);
    std::vector<char> bytes(static_cast<std::size_t>(size));
    MPI_Recv(bytes.data(), size, MPI_BYTE, status.MPI_SOURCE, status.MPI_TAG, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
    return Packet(std::move(bytes));
  }
  std::string text() const { return {bytes_.begin(), bytes_.end()}; }

 private:
  void copy(void* to, std::size_t size) {
    if (size > bytes_.size() - at_) throw InputError("sweep: a message between ranks is damaged");
    if (size > 0) std::memcpy(to, bytes_.data() + at_, size);
    at_ += size;
  }
  std::vector<char> bytes_;
  std::size_t at_ = 0;
};

bool arrived(MPI_Status& status) {
  int flag = 0;
  MPI_Iprobe(MPI_ANY_SOURCE, MPI_ANY_TAG, MPI_COMM_WORLD, &flag, &status);
  return flag != 0;
}

}  // namespace

int launched_rank() {
  for (const char* name : {"OMPI_COMM_WORLD_RANK", "PMIX_RANK", "PMI_RANK", "SLURM_PROCID"}) {
    // an interactive shell within an allocation has SLURM_PROCID too, but is no step of several tasks
    if (std::strcmp(name, "SLURM_PROCID") == 0) {
      const char* tasks = std::getenv("SLURM_STEP_NUM_TASKS");
      if (!tasks || std::atoi(tasks) < 2) continue;
    }
    if (const char* value = std::getenv(name)) return std::atoi(value);
  }
  return -1;
}

SweepRanks::SweepRanks() {
  if (launched_rank() < 0) return;
  int provided = 0;
  MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &provided);
  active_ = true;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
  MPI_Comm_size(MPI_COMM_WORLD, &size_);
  MPI_Comm_set_errhandler(MPI_COMM_WORLD, MPI_ERRORS_RETURN);
  last_heard_.assign(static_cast<std::size_t>(size_), Clock::now());
  dead_.assign(static_cast<std::size_t>(size_), false);
}

SweepRanks::~SweepRanks() {
  if (!active_) return;
  bool all_alive = true;
  if (rank_ == 0) {
    for (int other = 1; other < size_; ++other) {
      if (dead_[static_cast<std::size_t>(other)]) {
        all_alive = false;
      } else {
        Packet().send(other, kStop);
      }
    }
    // what was still under way is not wanted any more, but must be received for the senders to get free
    const auto give_up = Clock::now() + std::chrono::seconds(5);
    std::vector<bool> gone(static_cast<std::size_t>(size_), false);
    for (int left = all_alive ? size_ - 1 : 0; left > 0 && Clock::now() < give_up;) {
      MPI_Status status;
      if (!arrived(status)) {
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
        continue;
      }
      Packet::receive(status);
      if (status.MPI_TAG == kStop) --left;
    }
  } else {
    Packet().send(0, kStop);
  }
  if (all_alive) {
    MPI_Finalize();
  } else {
    // A dead rank would never come to MPI_Finalize. The others are ended with this process, by its own exit code.
    on_exit(
        [](int code, void*) {
          std::fflush(nullptr);
          MPI_Abort(MPI_COMM_WORLD, code);
        },
        nullptr);
  }
}

void SweepRanks::poll(std::vector<SweepBlockResult>& results) {
  if (!active_) return;
  MPI_Status status;
  while (arrived(status)) {
    const int from = status.MPI_SOURCE;
    Packet packet = Packet::receive(status);
    last_heard_[static_cast<std::size_t>(from)] = Clock::now();
    if (status.MPI_TAG == kRequest) {
      waiting_.push_back(from);
    } else if (status.MPI_TAG == kFailure) {
      throw InputError("rank " + std::to_string(from) + ": " + packet.text());
    } else if (status.MPI_TAG == kResult) {
      SweepBlockResult result;
      result.block = packet.take<SweepBlock>();
      result.seconds = packet.take<double>();
      result.evaluations = packet.take_all<Evaluation>();
      result.statistics = packet.take_all<PointStatistics>();
      result.rank = from;
      // a block that was given up and came back after all is taken once
      if (given_.erase({result.block.first_point, result.block.first_arm}) > 0) results.push_back(std::move(result));
    }
  }
}

void SweepRanks::give(const SweepTask& task) {
  const int rank = waiting_.front();
  waiting_.pop_front();
  Packet().put(task.block).put_all(task.points).send(rank, kTask);
  given_[{task.block.first_point, task.block.first_arm}] = {task, rank};
}

std::size_t SweepRanks::outstanding() const {
  return given_.size();
}

std::vector<SweepTask> SweepRanks::reclaim(std::string& report) {
  std::vector<SweepTask> tasks;
  const Clock::time_point now = Clock::now();
  for (int rank = 1; rank < size_; ++rank) {
    const auto r = static_cast<std::size_t>(rank);
    if (dead_[r] || now - last_heard_[r] < kSilence) continue;
    dead_[r] = true;
    std::erase(waiting_, rank);
    for (auto it = given_.begin(); it != given_.end();) {
      if (it->second.rank != rank) {
        ++it;
        continue;
      }
      tasks.push_back(std::move(it->second.task));
      it = given_.erase(it);
    }
    report += "rank " + std::to_string(rank) + " has been silent for 20 s: given up, its " +
              std::to_string(tasks.size()) + " blocks are handed out again";
  }
  return tasks;
}

std::string SweepRanks::whereabouts() const {
  std::string text;
  for (const auto& [key, given] : given_) {
    const SweepBlock& block = given.task.block;
    text += (text.empty() ? "rank " : "; rank ") + std::to_string(given.rank) + ": points " +
            std::to_string(block.first_point) + "-" + std::to_string(block.first_point + block.point_count - 1);
  }
  return text;
}

void SweepRanks::serve(SweepPool& pool) {
  auto heartbeat = Clock::now();
  for (int i = 0; i < pool.threads() + 1; ++i) Packet().send(0, kRequest);  // one in reserve, so that nobody idles
  while (true) {
    MPI_Status status;
    while (arrived(status)) {
      Packet packet = Packet::receive(status);
      if (status.MPI_TAG == kStop) return;
      if (status.MPI_TAG != kTask) continue;
      SweepTask task;
      task.block = packet.take<SweepBlock>();
      task.points = packet.take_all<SweepPoint>();
      pool.submit(std::move(task));
    }
    if (const auto result = pool.collect(std::chrono::milliseconds(1))) {
      Packet()
          .put(result->block)
          .put(result->seconds)
          .put_all(result->evaluations)
          .put_all(result->statistics)
          .send(0, kResult);
      Packet().send(0, kRequest);
    }
    if (Clock::now() - heartbeat > kHeartbeat) {
      heartbeat = Clock::now();
      Packet().send(0, kAlive);
    }
  }
}

void SweepRanks::report_failure(const std::string& what) {
  MPI_Send(what.data(), static_cast<int>(what.size()), MPI_BYTE, 0, kFailure, MPI_COMM_WORLD);
}

}  // namespace handloop::studies
#pragma GCC diagnostic pop
