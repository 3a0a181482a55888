#include "device/recorder.h"

#include <chrono>

namespace handloop::device {

bool DirectRecorder::take(const StepRecord& record) noexcept {
  return log_.add(record);
}

bool DirectRecorder::finish() noexcept {
  return log_.close();
}

ThreadedRecorder::ThreadedRecorder(LogFile& log) : log_(log), writer_([this] { write_out(); }) {}

ThreadedRecorder::~ThreadedRecorder() {
  finish();
}

bool ThreadedRecorder::take(const StepRecord& record) noexcept {
  ring_.push(record);
  return !failed_.load(std::memory_order_relaxed);
}

bool ThreadedRecorder::finish() noexcept {
  end_.store(true, std::memory_order_release);
  if (writer_.joinable()) writer_.join();
  return log_.close() && ring_.lost() == 0;
}

void ThreadedRecorder::write_out() {
  using namespace std::chrono_literals;
  StepRecord record;
  while (true) {
    // Asked before the ring is emptied: whatever was pushed before the end is then still written.
    const bool last_round = end_.load(std::memory_order_acquire);
    bool any = false;
    while (ring_.pop(record)) {
      any = true;
      if (!log_.add(record)) failed_.store(true, std::memory_order_relaxed);
    }
    if (last_round) return;
    if (any && !log_.flush()) failed_.store(true, std::memory_order_relaxed);
    std::this_thread::sleep_for(20ms);
  }
}

}  // namespace handloop::device
