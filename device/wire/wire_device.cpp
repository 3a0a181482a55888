#include "device/wire/wire_device.h"

#include <algorithm>
#include <chrono>

#include "device/scales.h"
#include "models/errors.h"

namespace handloop::device::wire {
namespace {

using Steady = std::chrono::steady_clock;
constexpr std::int64_t kFirstTry_us = 5'000;
constexpr std::int64_t kLongestTry_us = 100'000;
/// After one long wait in vain the next waits are short: the watchdog is to count samples, not minutes.
constexpr int kShortPatience_ms = 20;

std::int64_t us_until(Steady::time_point end) {
  return std::chrono::duration_cast<std::chrono::microseconds>(end - Steady::now()).count();
}

}  // namespace

WireDevice::WireDevice(const DeviceDescription& description, WireOptions options)
    : description_(description), options_(std::move(options)), socket_(Socket::towards(options_.plant)) {}

WireDevice::~WireDevice() {
  WireDevice::stop();
}

bool WireDevice::send(const Packet& packet) {
  std::array<std::byte, kMaxPacketBytes> bytes;
  const std::size_t size = encode(packet, options_.key ? &*options_.key : nullptr, bytes);
  ++counters_.sent;
  return socket_.send(std::span(bytes).first(size), options_.plant);
}

bool WireDevice::receive(Packet& packet, std::int64_t timeout_us) {
  std::array<std::byte, kMaxPacketBytes + 1> bytes;
  const auto end = Steady::now() + std::chrono::microseconds(timeout_us);
  while (true) {
    Address from;
    const auto size = socket_.receive(bytes, from, std::max<std::int64_t>(us_until(end), 0));
    if (!size) return false;
    ++counters_.received;
    if (!(from == options_.plant)) {
      ++counters_.wrong_session;
      continue;
    }
    const auto verdict =
        decode(std::span(bytes).first(std::min(*size, bytes.size())), options_.key ? &*options_.key : nullptr, packet);
    ++counters_.by_verdict[static_cast<std::size_t>(verdict)];
    if (verdict == Verdict::good) return true;
    if (verdict == Verdict::not_authenticated) untagged_seen_ = true;
  }
}

void WireDevice::start() {
  stop();
  counters_ = {};
  nonce_ = random_number();
  untagged_seen_ = fresh_ = awaiting_ = false;
  latest_ = {};
  patience_ms_ = options_.patience_ms;
  Packet open;
  open.type = PacketType::open;
  open.flags = options_.lock_step ? kLockStep : 0;
  open.nonce = nonce_;
  open.scenario_hash = options_.scenario_hash;
  open.seed = options_.seed;

  const auto end = Steady::now() + std::chrono::milliseconds(options_.patience_ms);
  Refusal refusal = Refusal::none;
  while (us_until(end) > 0) {
    send(open);
    const auto again = std::min(end, Steady::now() + std::chrono::milliseconds(100));
    Packet answer;
    while (us_until(again) > 0 && receive(answer, us_until(again))) {
      // Answers to an older opening carry its nonce, not this one's.
      if (answer.nonce != nonce_) continue;
      if (answer.type == PacketType::refuse) {
        refusal = answer.refusal;
        // A plant that is held may come free in time; nothing else gets better by asking again.
        if (refusal != Refusal::busy) {
          throw RequirementError("the plant at " + options_.plant.text() +
                                 " refused: " + std::string(refusal_text(refusal)));
        }
      } else if (answer.type == PacketType::accept) {
        session_ = answer.session;
        latest_ = answer.reading;
        fresh_ = true;
        open_ = true;
        return;
      }
    }
  }
  std::string why = "no plant answers at " + options_.plant.text() + " (start one: handloop plant SCENARIO --listen " +
                    options_.plant.text() + ")";
  if (refusal != Refusal::none)
    why = "the plant at " + options_.plant.text() + ": " + std::string(refusal_text(refusal));
  if (untagged_seen_) why += "; what answered there did not hold the same key (--key)";
  throw RequirementError(why);
}

void WireDevice::take(const Packet& packet) {
  if (packet.type != PacketType::reading || packet.session != session_) {
    ++counters_.wrong_session;
    return;
  }
  const Reading& reading = packet.reading;
  if (reading.sample == latest_.sample) {
    ++counters_.doubled;
  } else if (reading.sample < latest_.sample) {
    ++counters_.reordered;
  } else if (options_.lock_step && reading.sample != last_command_.sequence + 1) {
    ++counters_.ahead;
  } else {
    counters_.lost += reading.sample - latest_.sample - 1;
    latest_ = reading;
    fresh_ = true;
    awaiting_ = false;
  }
}

void WireDevice::await_next() {
  const auto end = Steady::now() + std::chrono::milliseconds(patience_ms_);
  std::int64_t try_us = kFirstTry_us;
  auto again = Steady::now() + std::chrono::microseconds(try_us);
  Packet packet;
  while (awaiting_ && us_until(end) > 0) {
    if (receive(packet, std::max<std::int64_t>(us_until(std::min(again, end)), 1))) {
      take(packet);
    } else if (us_until(again) <= 0) {
      send(last_command_);
      ++counters_.sent_again;
      try_us = std::min(2 * try_us, kLongestTry_us);
      again = Steady::now() + std::chrono::microseconds(try_us);
    }
  }
  patience_ms_ = awaiting_ ? kShortPatience_ms : options_.patience_ms;
}

Reading WireDevice::read() {
  if (options_.lock_step) {
    if (awaiting_) await_next();
  } else {
    Packet packet;
    while (receive(packet, 0)) take(packet);
    const auto half_a_sample =
        Steady::now() + std::chrono::microseconds(static_cast<std::int64_t>(0.5e6 * description_.sample_time_s));
    while (!fresh_ && us_until(half_a_sample) > 0 && receive(packet, us_until(half_a_sample))) take(packet);
  }
  Reading reading = latest_;
  reading.valid = fresh_ && latest_.valid;
  fresh_ = false;
  return reading;
}

bool WireDevice::write(const Command& command) {
  if (!open_) return false;
  last_command_ = {};
  last_command_.type = PacketType::command;
  last_command_.flags = options_.lock_step ? kLockStep : 0;
  last_command_.session = session_;
  last_command_.sequence = latest_.sample;
  last_command_.command = command;
  last_command_.command.sample = latest_.sample;
  awaiting_ = options_.lock_step;
  const bool sent = send(last_command_);
  // In lock-step the command is repeated until it is answered, so a send that failed is not yet a loss.
  return sent || options_.lock_step;
}

void WireDevice::stop() {
  if (!open_) return;
  if (!options_.lock_step) {
    Command zero;
    zero.dac_codes.fill(zero_code(description_));
    write(zero);
  }
  Packet close;
  close.type = PacketType::close;
  close.session = session_;
  close.sequence = latest_.sample + 1;
  // Twice, as it is not answered; should both be lost, the plant notices the silence.
  send(close);
  send(close);
  open_ = false;
}

}  // namespace handloop::device::wire
