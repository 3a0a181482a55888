// Runs inside QEMU, on Debian's kernel with its comedi_test driver: 8 analog outputs of 16 bits looped back to 8
// inputs. Prints what it finds; the last line is PROBE OK where all of it holds.
#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <exception>

#include "device/comedi/board_list.h"
#include "device/comedi/boards.h"
#include "device/comedi/guardian.h"
#include "device/latency.h"
#include "models/errors.h"

using namespace handloop;
using namespace handloop::device;
using namespace handloop::device::comedi;

namespace {

int failures = 0;

void check(bool holds, std::string_view what) {
  fmt::print("{} {}\n", holds ? "ok  " : "FAIL", what);
  failures += !holds;
}

ComediConfig::Motors motors() {
  ComediConfig::Motors config;
  config.board = "/dev/comedi0";
  config.subdevice = 1;
  return config;
}

ComediConfig::Force inputs() {
  ComediConfig::Force config;
  config.board = "/dev/comedi0";
  config.subdevice = 0;
  config.channels = {0, 1, 2};
  config.N_per_V = {1, 1, 1};
  config.differential = false;
  return config;
}

void loopback() {
  MotorOutputs out(motors());
  ForceInputs in(inputs());
  check(out.maxdata() == 65535 && in.maxdata() == 65535, "16 bits each way");
  std::array<std::uint32_t, kMaxAnalogInputs> read{};
  bool exact = true;
  for (std::uint32_t code = 0; code <= 65535; code += 257) {
    const std::array<std::uint32_t, kMaxMotors> codes{code, 65535 - code, (code * 7) % 65536};
    exact = exact && out.write(codes) && in.read(read);
    for (std::size_t i = 0; i < kMaxMotors; ++i) exact = exact && read[i] == codes[i];
  }
  check(exact, "what the outputs are given the inputs read, to the bit, as one instruction list each");
  check(out.write({65535, 0, 70000}) && in.read(read) && read[2] == out.zero(), "a code too large becomes zero");
  check(out.write_zero() && in.read(read) && read[0] == 32768 && read[1] == 32768 && read[2] == 32768, "zero is zero");

  LatencyHistogram took;
  for (int i = 0; i < 2000; ++i) {
    const auto begin = std::chrono::steady_clock::now();
    out.write({1u, 2u, 3u});
    in.read(read);
    took.add(std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now() - begin).count());
  }
  fmt::print("3 writes and 3 reads: p50 {:.1f}, p99 {:.1f} us (emulated)\n", took.percentile_us(0.5),
             took.percentile_us(0.99));
}

void killed_controller() {
  const pid_t child = fork();
  if (child == 0) {
    MotorOutputs out(motors());
    Guardian guardian(0.05, [&] { return out.write_zero(); });
    out.write({60000, 100, 50000});
    guardian.beat();
    raise(SIGKILL);
  }
  waitpid(child, nullptr, 0);
  ForceInputs in(inputs());
  std::array<std::uint32_t, kMaxAnalogInputs> read{};
  bool zero = false;
  for (int i = 0; i < 500 && !zero; ++i) {
    usleep(10'000);
    zero = in.read(read) && read[0] == 32768 && read[1] == 32768 && read[2] == 32768;
  }
  check(zero, "after kill -9 the guardian brings the outputs to zero");
}

void refusals() {
  const auto refused = [](auto&& make, std::string_view part) {
    try {
      make();
    } catch (const InputError& error) {
      return std::string(error.what()).find(part) != std::string::npos;
    }
    return false;
  };
  auto wrong = motors();
  wrong.subdevice = 0;
  check(refused([&] { MotorOutputs out(wrong); }, "not an analog output"), "an input is no output");
  wrong = motors();
  wrong.range_V = 7;
  check(refused([&] { MotorOutputs out(wrong); }, "no range of +-7 V"), "a range it does not have is named");
  wrong = motors();
  wrong.channels = {0, 1, 8};
  check(refused([&] { MotorOutputs out(wrong); }, "no number 8"), "a channel it does not have is named");
  check(refused([] { EncoderCounters counters({.board = "/dev/comedi0"}); }, "/dev/comedi0"), "it has no counters");
  check(refused([] { open_board("/dev/comedi7"); }, "no Comedi board"), "a board that is not there");
}

}  // namespace

int main() {
  try {
    for (const auto& board : list_boards()) {
      fmt::print("{}: {} {}: {} inputs, {} outputs\n", board.path, board.name, board.problem, board.analog_inputs,
                 board.analog_outputs);
    }
    loopback();
    killed_controller();
    refusals();
  } catch (const std::exception& error) {
    check(false, error.what());
  }
  fmt::print("{}\n", failures == 0 ? "PROBE OK" : "PROBE FAILED");
  return failures == 0 ? 0 : 1;
}
