#include "device/wire/socket.h"

#include <arpa/inet.h>
#include <netdb.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstring>
#include <memory>

#include "models/errors.h"

namespace handloop::device::wire {
namespace {

sockaddr* generic(sockaddr_storage& storage) {
  return reinterpret_cast<sockaddr*>(&storage);
}
const sockaddr* generic(const sockaddr_storage& storage) {
  return reinterpret_cast<const sockaddr*>(&storage);
}

}  // namespace

bool Address::operator==(const Address& other) const {
  return length == other.length && std::memcmp(&storage, &other.storage, length) == 0;
}

std::string Address::text() const {
  char host[NI_MAXHOST], port[NI_MAXSERV];
  if (getnameinfo(generic(storage), length, host, sizeof host, port, sizeof port, NI_NUMERICHOST | NI_NUMERICSERV) !=
      0) {
    return "?";
  }
  const std::string shown = storage.ss_family == AF_INET6 ? std::string(1, '[').append(host).append("]") : host;
  return shown + ":" + port;
}

bool Address::loopback() const {
  if (storage.ss_family == AF_INET) {
    return (ntohl(reinterpret_cast<const sockaddr_in&>(storage).sin_addr.s_addr) >> 24) == 127;
  }
  return storage.ss_family == AF_INET6 &&
         IN6_IS_ADDR_LOOPBACK(&reinterpret_cast<const sockaddr_in6&>(storage).sin6_addr);
}

Address parse_address(std::string_view text, std::string_view what) {
  const auto fail = [&](std::string_view why) -> Address {
    throw InputError(std::string(what) + " '" + std::string(text) + "': " + std::string(why) +
                     "; give HOST:PORT, for example 127.0.0.1:47113");
  };
  std::string host, port;
  if (text.starts_with('[')) {
    const auto end = text.find("]:");
    if (end == std::string_view::npos) return fail("the bracket is not followed by ]:PORT");
    host = text.substr(1, end - 1);
    port = text.substr(end + 2);
  } else if (const auto colon = text.rfind(':'); colon != std::string_view::npos) {
    host = text.substr(0, colon);
    port = text.substr(colon + 1);
  } else {
    port = text;
  }
  unsigned number = 0;
  const auto [end, error] = std::from_chars(port.data(), port.data() + port.size(), number);
  if (error != std::errc{} || end != port.data() + port.size() || number > 65535) {
    return fail("the port is not a number from 0 to 65535");
  }
  if (host.empty()) host = "127.0.0.1";
  addrinfo hints{};
  hints.ai_family = AF_UNSPEC;
  hints.ai_socktype = SOCK_DGRAM;
  addrinfo* found = nullptr;
  if (const int code = getaddrinfo(host.c_str(), port.c_str(), &hints, &found); code != 0) {
    return fail("no such host (" + std::string(gai_strerror(code)) + ")");
  }
  const std::unique_ptr<addrinfo, void (*)(addrinfo*)> guard(found, &freeaddrinfo);
  Address address;
  std::memcpy(&address.storage, found->ai_addr, found->ai_addrlen);
  address.length = found->ai_addrlen;
  return address;
}

Socket Socket::bound(const Address& address) {
  Socket made(::socket(address.storage.ss_family, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  if (made.descriptor_ < 0 || ::bind(made.descriptor_, generic(address.storage), address.length) != 0) {
    throw InputError("cannot listen on " + address.text() + ": " + std::strerror(errno));
  }
  return made;
}

Socket Socket::towards(const Address& peer) {
  Socket made(::socket(peer.storage.ss_family, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  if (made.descriptor_ < 0) throw InputError("no socket for " + peer.text() + ": " + std::strerror(errno));
  return made;
}

Socket::~Socket() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

Socket::Socket(Socket&& other) noexcept : descriptor_(other.descriptor_) {
  other.descriptor_ = -1;
}

bool Socket::send(std::span<const std::byte> datagram, const Address& to) noexcept {
  return ::sendto(descriptor_, datagram.data(), datagram.size(), MSG_DONTWAIT | MSG_NOSIGNAL, generic(to.storage),
                  to.length) == static_cast<ssize_t>(datagram.size());
}

std::optional<std::size_t> Socket::receive(std::span<std::byte> buffer, Address& from,
                                           std::int64_t timeout_us) noexcept {
  if (timeout_us > 0) {
    pollfd waiting{descriptor_, POLLIN, 0};
    const timespec limit{timeout_us / 1'000'000, timeout_us % 1'000'000 * 1000};
    if (::ppoll(&waiting, 1, &limit, nullptr) <= 0) return std::nullopt;
  }
  from = {};
  from.length = sizeof from.storage;
  const auto size = ::recvfrom(descriptor_, buffer.data(), buffer.size(), MSG_DONTWAIT | MSG_TRUNC,
                               generic(from.storage), &from.length);
  if (size < 0) return std::nullopt;
  return static_cast<std::size_t>(size);
}

Address Socket::local() const {
  Address address;
  address.length = sizeof address.storage;
  ::getsockname(descriptor_, generic(address.storage), &address.length);
  return address;
}

}  // namespace handloop::device::wire
