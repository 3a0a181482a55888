#pragma once

#include <atomic>
#include <memory>
#include <thread>

#include "device/log_file.h"
#include "device/record.h"
#include "device/ring_buffer.h"

namespace handloop::device {

/// Takes what the loop did. take() returns false where records are being lost for good (a full disk).
class Recorder {
 public:
  virtual ~Recorder() = default;
  virtual bool take(const StepRecord& record) noexcept = 0;
  /// Everything taken is in the file when this returns; false where it is not.
  virtual bool finish() noexcept = 0;
};

/// Writes in the loop's own thread: for lock-step runs, where no clock waits.
class DirectRecorder final : public Recorder {
 public:
  explicit DirectRecorder(LogFile& log) : log_(log) {}
  bool take(const StepRecord& record) noexcept override;
  bool finish() noexcept override;

 private:
  LogFile& log_;
};

/// Hands records to a thread that writes them: take() is real-time safe. The ring holds 8 s at 1 kHz; a disk that
/// stalls for longer loses records, which are counted.
class ThreadedRecorder final : public Recorder {
 public:
  explicit ThreadedRecorder(LogFile& log);
  ~ThreadedRecorder() override;
  bool take(const StepRecord& record) noexcept override;
  bool finish() noexcept override;
  std::size_t lost() const noexcept { return ring_.lost(); }

 private:
  void write_out();

  LogFile& log_;
  RingBuffer<StepRecord, 8192> ring_;
  std::atomic<bool> end_{false};
  std::atomic<bool> failed_{false};
  std::thread writer_;
};

}  // namespace handloop::device
