#pragma once

#include <array>
#include <atomic>
#include <deque>
#include <functional>
#include <random>
#include <thread>
#include <vector>

#include "device/wire/packet.h"
#include "device/wire/socket.h"

namespace handloop::device::wire {

using Bytes = std::vector<std::byte>;

/// A bad network between controller and plant: passes datagrams on, each through a script that may drop, double, keep
/// back or spoil it. The script returns what goes on in the place of one datagram.
class Relay {
 public:
  using Script = std::function<std::vector<Bytes>(const Bytes&, bool to_plant)>;

  Relay(const Address& plant, Script script)
      : plant_(plant),
        front_(Socket::bound(parse_address("127.0.0.1:0", "relay"))),
        back_(Socket::towards(plant)),
        script_(std::move(script)),
        thread_([this] { pass_on(); }) {}
  ~Relay() { end(); }
  /// Passes nothing on any more.
  void end() {
    stop_ = true;
    if (thread_.joinable()) thread_.join();
  }
  Address address() const { return front_.local(); }
  /// Everything that was sent towards the plant, as sent. To be read after end().
  const std::vector<Bytes>& seen() const { return seen_; }

 private:
  void pass_on() {
    std::array<std::byte, 2048> buffer;
    Address from, controller;
    while (!stop_) {
      if (const auto size = front_.receive(buffer, from, 200)) {
        controller = from;
        const Bytes datagram(buffer.begin(), buffer.begin() + static_cast<std::ptrdiff_t>(*size));
        seen_.push_back(datagram);
        for (const auto& bytes : script_(datagram, true)) back_.send(bytes, plant_);
      }
      while (const auto size = back_.receive(buffer, from, 0)) {
        const Bytes datagram(buffer.begin(), buffer.begin() + static_cast<std::ptrdiff_t>(*size));
        for (const auto& bytes : script_(datagram, false)) front_.send(bytes, controller);
      }
    }
  }

  Address plant_;
  Socket front_, back_;
  Script script_;
  std::vector<Bytes> seen_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace handloop::device::wire
