#pragma once

#include <netinet/in.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace handloop::device::wire {

/// A UDP end point.
struct Address {
  sockaddr_storage storage{};
  socklen_t length = 0;

  bool operator==(const Address& other) const;
  std::string text() const;
  bool loopback() const;
};

/// "HOST:PORT", "[IPv6]:PORT", ":PORT" or "PORT"; without a host it is 127.0.0.1. Throws InputError naming `what` where
/// it cannot be understood or resolved.
Address parse_address(std::string_view text, std::string_view what);

/// A UDP socket. Not copied; send and receive are real-time safe as far as the system is.
class Socket {
 public:
  /// Bound to an address (port 0: any free one). Throws InputError naming the address where that is not possible.
  static Socket bound(const Address& address);
  /// On any free port, talking to `peer`.
  static Socket towards(const Address& peer);
  ~Socket();
  Socket(Socket&& other) noexcept;
  Socket& operator=(Socket&&) = delete;

  bool send(std::span<const std::byte> datagram, const Address& to) noexcept;
  /// Waits at most `timeout_us` (0: not at all) for a datagram. Nothing where none came; a datagram larger than the
  /// buffer is reported with its true size, which the caller sees to be too much.
  std::optional<std::size_t> receive(std::span<std::byte> buffer, Address& from, std::int64_t timeout_us) noexcept;
  Address local() const;
  int descriptor() const { return descriptor_; }

 private:
  explicit Socket(int descriptor) : descriptor_(descriptor) {}
  int descriptor_ = -1;
};

}  // namespace handloop::device::wire
