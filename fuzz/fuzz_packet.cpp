#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <string>

#include "device/wire/packet.h"
#include "fuzz/refused.h"

using namespace handloop;
using namespace handloop::device;

/// Any datagram is safe to decode; one that is accepted says the same when it is encoded again.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const wire::Authenticator key("sixteen bytes or more");
  const auto datagram = std::as_bytes(std::span(data, size));
  for (const wire::Authenticator* authenticator : {static_cast<const wire::Authenticator*>(nullptr), &key}) {
    wire::Packet packet;
    if (wire::decode(datagram, authenticator, packet) != wire::Verdict::good) continue;
    std::array<std::byte, wire::kMaxPacketBytes> again;
    const std::size_t length = wire::encode(packet, authenticator, again);
    fuzz::require(length == size && std::equal(datagram.begin(), datagram.end(), again.begin()),
                  "an accepted packet is encoded to the same bytes");
  }
  return 0;
}
