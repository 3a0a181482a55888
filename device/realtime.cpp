#include "device/realtime.h"

#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>

#include <array>
#include <cerrno>
#include <cstring>

namespace handloop::device {
namespace {

[[gnu::noinline]] void touch_stack(std::size_t bytes) {
  constexpr std::size_t kPage = 4096;
  std::array<char, kPage> page;
  page.fill(0);
  asm volatile("" : : "r"(page.data()) : "memory");  // the compiler may not drop what it thinks nobody reads
  if (bytes > kPage) touch_stack(bytes - kPage);
  asm volatile("" : : "r"(page.data()) : "memory");  // nor reuse this frame for the deeper call
}

}  // namespace

RealtimeGrant request_realtime(int priority, std::size_t stack_bytes) {
  RealtimeGrant grant;
  grant.priority = priority;
  sched_param parameters{};
  parameters.sched_priority = priority;
  if (const int error = pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameters); error == 0) {
    grant.fifo = true;
  } else {
    grant.refused.push_back(std::string("SCHED_FIFO: ") + std::strerror(error) +
                            " (give the user an rtprio limit in /etc/security/limits.d)");
  }
  if (mlockall(MCL_CURRENT | MCL_FUTURE) == 0) {
    grant.memory_locked = true;
  } else {
    grant.refused.push_back(std::string("mlockall: ") + std::strerror(errno) +
                            " (give the user a memlock limit in /etc/security/limits.d)");
  }
  touch_stack(stack_bytes);
  return grant;
}

void release_realtime() {
  sched_param parameters{};
  pthread_setschedparam(pthread_self(), SCHED_OTHER, &parameters);
}

}  // namespace handloop::device
