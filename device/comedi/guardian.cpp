#include "device/comedi/guardian.h"

#include <poll.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <new>
#include <string>

#include "models/errors.h"

namespace handloop::device::comedi {

Guardian::Guardian(double watchdog_s, std::function<bool()> zero) {
  void* memory = ::mmap(nullptr, sizeof(Shared), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  int ends[2] = {-1, -1};
  if (memory == MAP_FAILED || ::pipe(ends) != 0) {
    throw InputError(std::string("no guardian for the motors: ") + std::strerror(errno));
  }
  state_ = new (memory) Shared{};
  child_ = ::fork();
  if (child_ < 0) throw InputError(std::string("no guardian for the motors: ") + std::strerror(errno));
  if (child_ == 0) {
    ::close(ends[1]);
    watch(ends[0], watchdog_s, zero);
  }
  ::close(ends[0]);
  pipe_ = ends[1];
}

Guardian::~Guardian() {
  const char in_order = 'q';
  if (::write(pipe_, &in_order, 1) != 1) ::kill(child_, SIGKILL);
  ::close(pipe_);
  int status = 0;
  while (::waitpid(child_, &status, 0) < 0 && errno == EINTR) {
  }
  ::munmap(state_, sizeof(Shared));
}

void Guardian::watch(int pipe, double watchdog_s, const std::function<bool()>& zero) {
  // Signals meant for the controller (Ctrl-C goes to the whole group) must not take its guardian away.
  ::setsid();
  for (const int number : {SIGINT, SIGTERM, SIGHUP, SIGPIPE, SIGQUIT}) std::signal(number, SIG_IGN);
  // One above the loop, so that a loop that spins at its priority cannot starve it. Not granted is no harm.
  sched_param parameters{};
  parameters.sched_priority = 51;
  sched_setscheduler(0, SCHED_FIFO, &parameters);

  using Clock = std::chrono::steady_clock;
  const int poll_ms = std::max(1, static_cast<int>(watchdog_s * 1e3 / 4));
  // From nought, not from what it is by now: a controller may have begun, and stopped, before this process first ran.
  std::uint64_t last = 0;
  bool begun = false, zeroed = false;
  auto heard = Clock::now();
  while (true) {
    pollfd waiting{pipe, POLLIN, 0};
    if (::poll(&waiting, 1, poll_ms) > 0) {
      char word = 0;
      const auto got = ::read(pipe, &word, 1);
      if (got == 1 && word == 'q') ::_exit(0);
      if (got == 0) {
        // The parent is gone and did not say so. A board may be busy with its last call: try for a while.
        state_->interventions.fetch_add(1, std::memory_order_relaxed);
        for (int attempt = 0; attempt < 100 && !zero(); ++attempt) ::usleep(10'000);
        ::_exit(1);
      }
    }
    const std::uint64_t beats = state_->beats.load(std::memory_order_relaxed);
    if (beats != last) {
      last = beats;
      heard = Clock::now();
      begun = true;
      zeroed = false;
    } else if (begun && std::chrono::duration<double>(Clock::now() - heard).count() > watchdog_s) {
      if (!zeroed) state_->interventions.fetch_add(1, std::memory_order_relaxed);
      zeroed = zero();
    }
  }
}

}  // namespace handloop::device::comedi
