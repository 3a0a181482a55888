#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <string>

#include "device/wire/packet.h"
#include "fuzz/refused.h"

using namespace handloop;
using namespace handloop::device;

namespace {

/// Any datagram is safe to decode; one that is accepted says the same when it is encoded again.
void take(std::span<const std::byte> datagram) {
  static const wire::Authenticator key("sixteen bytes or more");
  for (const wire::Authenticator* authenticator : {static_cast<const wire::Authenticator*>(nullptr), &key}) {
    wire::Packet packet;
    if (wire::decode(datagram, authenticator, packet) != wire::Verdict::good) continue;
    std::array<std::byte, wire::kMaxPacketBytes> again;
    const std::size_t length = wire::encode(packet, authenticator, again);
    fuzz::require(length == datagram.size() && std::equal(datagram.begin(), datagram.end(), again.begin()),
                  "an accepted packet is encoded to the same bytes");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::span bytes(data, size);
  take(std::as_bytes(bytes));
  // Mutations hardly ever hit the checksum: put right, so that what lies behind it is tried as well.
  if (size >= wire::kHeaderBytes) {
    std::string repaired(bytes.begin(), bytes.end());
    wire::seal(std::as_writable_bytes(std::span(repaired)));
    take(std::as_bytes(std::span(repaired)));
  }
  return 0;
}
