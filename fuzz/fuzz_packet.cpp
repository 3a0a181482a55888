#include <zlib.h>

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

/// The same with its checksum put right (bytes 28 to 31: CRC-32 of all, they themselves as 0), which mutations hardly
/// ever hit: what lies behind it is tried as well.
std::string with_checksum(std::string datagram) {
  constexpr std::size_t kAt = 28, kBytes = 4;
  if (datagram.size() < wire::kHeaderBytes) return datagram;
  std::fill_n(datagram.begin() + kAt, kBytes, '\0');
  auto crc = crc32(0, reinterpret_cast<const Bytef*>(datagram.data()), static_cast<uInt>(datagram.size()));
  for (std::size_t i = 0; i < kBytes; ++i, crc >>= 8) datagram[kAt + i] = static_cast<char>(crc & 0xff);
  return datagram;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::span bytes(data, size);
  take(std::as_bytes(bytes));
  const std::string repaired = with_checksum({bytes.begin(), bytes.end()});
  take(std::as_bytes(std::span(repaired)));
  return 0;
}
