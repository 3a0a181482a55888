#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <optional>

#include "device/device.h"
#include "device/timing.h"
#include "device/wire/authenticator.h"
#include "device/wire/counters.h"
#include "device/wire/socket.h"

namespace handloop::device::wire {

struct ServerOptions {
  Address listen;
  std::uint64_t scenario_hash = 0;
  std::optional<Authenticator> key;
  int silence_samples = 20;  ///< of no command, after which the DACs go to zero (real time)
  double idle_s = 2.0;       ///< of no packet, after which the session ends and another controller may come
};

/// Makes the device that a session with this seed runs on.
using PlantFactory = std::function<std::unique_ptr<Device>(std::uint64_t seed)>;

/// Serves a device to one controller at a time. Each session starts the plant afresh. Packets are taken only from the
/// end point that opened the session and only with its session number, which the plant chose at random; with a key,
/// only authenticated ones. So a packet recorded in one session means nothing in another, and within a session a
/// command counts once.
///
/// Lock-step: command n moves the plant to sample n + 1 and is answered by that reading; a repeated command n is
/// answered by the same reading again. Real time: the plant keeps its own time, sends a reading every sample and holds
/// the newest command; after `silence_samples` without one its DACs go to zero until the next.
class PlantServer {
 public:
  /// Throws InputError where the address cannot be bound.
  PlantServer(ServerOptions options, PlantFactory factory);
  ~PlantServer();

  Address address() const { return socket_.local(); }
  /// Serves until `stop` is set; zeroes the plant on every way out.
  void serve(const std::atomic<bool>& stop);

  // Of all sessions so far. To be asked from the serving thread or after serve().
  const Counters& counters() const { return counters_; }
  std::uint64_t sessions() const { return sessions_; }

 private:
  void send(const Packet& packet, const Address& to, bool tagged = true);
  void refuse(Refusal refusal, std::uint64_t nonce, const Address& to, bool tagged);
  void take(std::span<const std::byte> datagram, const Address& from);
  void open(const Packet& packet, const Address& from);
  void accept();
  void command(const Packet& packet);
  void run_sample();
  void send_reading();
  void end_session() noexcept;

  ServerOptions options_;
  PlantFactory factory_;
  Socket socket_;
  Counters counters_;
  std::uint64_t sessions_ = 0;

  std::unique_ptr<Device> plant_;  ///< null between sessions
  Address peer_;
  std::uint64_t session_ = 0, nonce_ = 0;
  bool lock_step_ = true;
  Reading reading_;  ///< the present sample
  Command held_;
  std::uint64_t last_command_ = 0;  ///< sample the newest command belongs to
  bool commanded_ = false;
  int silent_samples_ = 0;
  bool silenced_ = false;
  std::int64_t last_heard_ns_ = 0;
  Schedule schedule_;
  MonotonicClock clock_;
};

}  // namespace handloop::device::wire
