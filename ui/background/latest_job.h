#pragma once

#include <atomic>
#include <condition_variable>
#include <exception>
#include <functional>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>
#include <utility>

namespace handloop::ui {

/// What a background job tells the window, and learns from it.
class JobContext {
 public:
  JobContext(std::stop_token stop, std::atomic<double>& share, std::mutex& mutex, std::string& note)
      : stop_(std::move(stop)), share_(share), mutex_(mutex), note_(note) {}
  /// Asked for by cancel(), by a newer request, and at the end of the program: return soon, with anything.
  bool cancelled() const { return stop_.stop_requested(); }
  std::stop_token stop_token() const { return stop_; }
  void progress(double share, const std::string& note = "") {
    share_.store(share, std::memory_order_relaxed);
    if (note.empty()) return;
    const std::lock_guard lock(mutex_);
    note_ = note;
  }

 private:
  std::stop_token stop_;
  std::atomic<double>& share_;
  std::mutex& mutex_;
  std::string& note_;
};

/// One kind of computation in a thread of its own. A newer request replaces one that waits and stops one that runs:
/// while a slider moves only the latest answer counts. The members are for one thread, the window's; none of them waits
/// for the work.
template <typename Result>
class LatestJob {
 public:
  using Work = std::function<std::optional<Result>(JobContext&)>;

  LatestJob() : thread_([this](std::stop_token end) { serve(end); }) {}
  ~LatestJob() {
    cancel();
    thread_.request_stop();
    wake_.notify_all();
  }
  LatestJob(const LatestJob&) = delete;
  LatestJob& operator=(const LatestJob&) = delete;

  /// `interrupt` false: what runs may finish and is shown, then the newest request follows; for work that is short but
  /// would otherwise never be seen while a slider moves.
  void request(Work work, bool interrupt = true) {
    const std::lock_guard lock(mutex_);
    waiting_ = std::move(work);
    if (interrupt) running_stop_.request_stop();
    busy_.store(true, std::memory_order_relaxed);
    wake_.notify_one();
  }
  void cancel() {
    const std::lock_guard lock(mutex_);
    waiting_ = nullptr;
    running_stop_.request_stop();
  }
  bool busy() const { return busy_.load(std::memory_order_relaxed); }
  double share() const { return share_.load(std::memory_order_relaxed); }
  std::string note() {
    const std::lock_guard lock(note_mutex_);
    return note_;
  }

  /// The newest finished result not yet taken.
  std::optional<Result> take() {
    const std::lock_guard lock(mutex_);
    std::optional<Result> result = std::move(finished_);
    finished_.reset();
    return result;
  }
  /// What went wrong with a request since this was last asked, "" where nothing did.
  std::string take_error() {
    const std::lock_guard lock(mutex_);
    return std::exchange(error_, {});
  }

 private:
  void serve(std::stop_token end) {
    while (true) {
      Work work;
      std::stop_source stop;
      {
        std::unique_lock lock(mutex_);
        if (!waiting_) busy_.store(false, std::memory_order_relaxed);
        wake_.wait(lock, end, [this] { return static_cast<bool>(waiting_); });
        if (end.stop_requested()) return;
        work = std::exchange(waiting_, nullptr);
        running_stop_ = stop;
        share_.store(0.0, std::memory_order_relaxed);
      }
      {
        const std::lock_guard lock(note_mutex_);
        note_.clear();
      }
      JobContext context(stop.get_token(), share_, note_mutex_, note_);
      std::optional<Result> result;
      std::string error;
      try {
        result = work(context);
      } catch (const std::exception& failure) {
        error = failure.what();
      }
      const std::lock_guard lock(mutex_);
      if (stop.stop_requested()) continue;  // nobody wants it any more
      if (result) finished_ = std::move(result);
      if (!error.empty()) error_ = error;
    }
  }

  std::mutex mutex_;
  std::condition_variable_any wake_;
  Work waiting_;
  std::stop_source running_stop_{std::nostopstate};
  std::optional<Result> finished_;
  std::string error_;
  std::atomic<bool> busy_{false};
  std::atomic<double> share_{0.0};
  std::mutex note_mutex_;
  std::string note_;
  std::jthread thread_;  ///< last: everything above exists while it runs
};

}  // namespace handloop::ui
