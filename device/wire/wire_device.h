#pragma once

#include <memory>
#include <optional>

#include "device/device.h"
#include "device/wire/authenticator.h"
#include "device/wire/counters.h"
#include "device/wire/socket.h"

namespace handloop::device::wire {

struct WireOptions {
  Address plant;
  std::uint64_t scenario_hash = 0;
  std::uint64_t seed = 1;
  bool lock_step = true;
  std::optional<Authenticator> key;
  int patience_ms = 2000;  ///< how long to wait for a plant, or in lock-step for an answer
};

/// A plant in another process. In lock-step each command is answered by the next reading and repeated until it is, so
/// that lost packets cost time but change nothing: the log is that of the simulation. Otherwise the plant keeps its own
/// time: read() takes the newest reading there is (waiting half a sample for it at most) and counts what is missing,
/// and the way there and back adds one to two samples to the loop's delay.
class WireDevice final : public Device {
 public:
  WireDevice(const DeviceDescription& description, WireOptions options);
  ~WireDevice() override;

  std::string_view name() const override { return "udp"; }
  const DeviceDescription& description() const override { return description_; }
  /// Throws RequirementError where no plant answers or it refuses.
  void start() override;
  Reading read() override;
  bool write(const Command& command) override;
  void stop() override;
  bool lock_step() const override { return options_.lock_step; }

  const Counters& counters() const { return counters_; }
  std::uint64_t session() const { return session_; }

 private:
  bool send(const Packet& packet);
  bool receive(Packet& packet, std::int64_t timeout_us);
  void take(const Packet& packet);
  void await_next();

  DeviceDescription description_;
  WireOptions options_;
  Socket socket_;
  Counters counters_;
  std::uint64_t session_ = 0;
  std::uint64_t nonce_ = 0;
  bool open_ = false;
  bool untagged_seen_ = false;

  Reading latest_;
  bool fresh_ = false;     ///< latest_ was not read yet
  bool awaiting_ = false;  ///< lock-step: a command waits for its answer
  Packet last_command_;
  int patience_ms_ = 0;
};

}  // namespace handloop::device::wire
