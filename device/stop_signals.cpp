#include "device/stop_signals.h"

#include <csignal>
#include <initializer_list>

namespace handloop::device {
namespace {

std::atomic<bool> stop_wanted{false};
std::atomic<int> signal_number{0};
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<int>::is_always_lock_free,
              "signal handlers may only touch lock-free atomics");

extern "C" void on_signal(int number) {
  signal_number.store(number, std::memory_order_relaxed);
  stop_wanted.store(true, std::memory_order_relaxed);
}

}  // namespace

const std::atomic<bool>& stop_on_signals() {
  struct sigaction action {};
  action.sa_handler = on_signal;
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  sigemptyset(&action.sa_mask);
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) sigaction(number, &action, nullptr);
  return stop_wanted;
}

int stop_signal() {
  return signal_number.load(std::memory_order_relaxed);
}

}  // namespace handloop::device
