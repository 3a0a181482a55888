#pragma once

#include <atomic>

namespace handloop::device {

/// From now on SIGINT, SIGTERM and SIGHUP set the returned flag instead of ending the program, so that a session can
/// end with the motors at zero and its log complete. A second signal of the kind ends the program at once. The flag
/// lives as long as the program.
const std::atomic<bool>& stop_on_signals();

/// The signal that came, 0 where none did.
int stop_signal();

}  // namespace handloop::device
