#pragma once

#include <string>
#include <vector>

namespace handloop::device {

/// What the operating system granted of real time. A refusal is no error: the loop then runs as an ordinary thread and
/// says so.
struct RealtimeGrant {
  bool fifo = false;  ///< SCHED_FIFO
  int priority = 0;
  bool memory_locked = false;        ///< mlockall
  std::vector<std::string> refused;  ///< one line each, with what would help
};

/// Asks for SCHED_FIFO at priority 50 (above ordinary threads, below the kernel's own) and locked memory for the
/// calling thread and process, and touches `stack_bytes` of stack so that no page is faulted in later. Not real-time
/// safe itself.
RealtimeGrant request_realtime(int priority = 50, std::size_t stack_bytes = 512 * 1024);

/// Back to an ordinary thread; memory stays locked.
void release_realtime();

}  // namespace handloop::device
