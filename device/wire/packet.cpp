#include "device/wire/packet.h"

#include <boost/crc.hpp>
#include <cstring>

namespace handloop::device::wire {
namespace {

constexpr std::uint32_t kMagic = 0x50574c48;  // "HLWP" in memory
constexpr std::size_t kChecksumAt = 28;

constexpr std::size_t kReadingBytes = 8 + 8 + 4 * kMaxMotors + 4 * kMaxAnalogInputs + 4;
constexpr std::size_t kCommandBytes = 8 + 4 * kMaxMotors;
static_assert(8 + 8 + kReadingBytes <= kMaxPayloadBytes);

/// Appends and takes numbers of fixed width, little-endian whatever the machine.
class Writer {
 public:
  explicit Writer(std::byte* out) : out_(out) {}
  template <typename T>
  void put(T value) {
    auto bits = static_cast<std::uint64_t>(value);
    for (std::size_t i = 0; i < sizeof(T); ++i, bits >>= 8) out_[at_++] = static_cast<std::byte>(bits & 0xff);
  }
  std::size_t size() const { return at_; }

 private:
  std::byte* out_;
  std::size_t at_ = 0;
};

class Reader {
 public:
  explicit Reader(const std::byte* in) : in_(in) {}
  template <typename T>
  T get() {
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < sizeof(T); ++i) bits |= static_cast<std::uint64_t>(in_[at_++]) << (8 * i);
    return static_cast<T>(bits);
  }

 private:
  const std::byte* in_;
  std::size_t at_ = 0;
};

/// Payload bytes of a type; 0 for an unknown one except close, which has none.
bool known(std::uint8_t type) {
  return type >= 1 && type <= 6;
}

std::size_t payload_bytes(PacketType type) {
  switch (type) {
    case PacketType::open:
      return 8 + 8 + 8;
    case PacketType::accept:
      return 8 + 8 + kReadingBytes;
    case PacketType::refuse:
      return 8 + 4;
    case PacketType::reading:
      return kReadingBytes;
    case PacketType::command:
      return kCommandBytes;
    case PacketType::close:
      return 0;
  }
  return 0;
}

void put_reading(Writer& out, const Reading& r) {
  out.put(r.sample);
  out.put(r.time_ns);
  for (const auto counts : r.encoder_counts) out.put(counts);
  for (const auto code : r.adc_codes) out.put(code);
  out.put<std::uint32_t>(r.valid ? 1 : 0);
}

/// False where a value cannot be.
bool get_reading(Reader& in, Reading& r) {
  r.sample = in.get<std::uint64_t>();
  r.time_ns = in.get<std::int64_t>();
  for (auto& counts : r.encoder_counts) counts = in.get<std::int32_t>();
  for (auto& code : r.adc_codes) code = in.get<std::uint32_t>();
  const auto valid = in.get<std::uint32_t>();
  r.valid = valid == 1;
  return valid <= 1 && r.time_ns >= 0;
}

std::uint32_t checksum(std::span<const std::byte> packet) {
  constexpr std::array<std::byte, 4> kNothing{};
  boost::crc_32_type crc;
  crc.process_bytes(packet.data(), kChecksumAt);
  crc.process_bytes(kNothing.data(), kNothing.size());
  crc.process_bytes(packet.data() + kHeaderBytes, packet.size() - kHeaderBytes);
  return crc.checksum();
}

}  // namespace

std::string_view refusal_text(Refusal refusal) {
  switch (refusal) {
    case Refusal::none:
      return "no reason";
    case Refusal::version:
      return "the plant speaks another version of the wire format";
    case Refusal::scenario:
      return "the plant runs another scenario (device, electronics, arm, hand or sample time differ)";
    case Refusal::busy:
      return "the plant is held by another controller";
    case Refusal::authentication:
      return "the plant wants authenticated packets (--key)";
    case Refusal::plant:
      return "the plant could not start";
  }
  return "unknown reason";
}

std::string_view verdict_name(Verdict verdict) {
  constexpr std::array<std::string_view, kVerdicts> kNames{
      "good",         "too_short",    "too_long",       "wrong_magic",       "wrong_version",
      "unknown_type", "wrong_length", "wrong_checksum", "not_authenticated", "impossible_value"};
  return kNames[static_cast<std::size_t>(verdict)];
}

std::size_t encode(const Packet& packet, const Authenticator* authenticator,
                   std::span<std::byte, kMaxPacketBytes> out) {
  Writer writer(out.data());
  const std::size_t payload = payload_bytes(packet.type);
  const auto flags =
      static_cast<std::uint8_t>((packet.flags & ~kAuthenticated) | (authenticator != nullptr ? kAuthenticated : 0));
  writer.put(kMagic);
  writer.put(kVersion);
  writer.put(static_cast<std::uint8_t>(packet.type));
  writer.put(flags);
  writer.put(packet.session);
  writer.put(packet.sequence);
  writer.put(static_cast<std::uint32_t>(payload));
  writer.put(std::uint32_t{0});
  switch (packet.type) {
    case PacketType::open:
      writer.put(packet.nonce);
      writer.put(packet.scenario_hash);
      writer.put(packet.seed);
      break;
    case PacketType::accept:
      writer.put(packet.nonce);
      writer.put(packet.scenario_hash);
      put_reading(writer, packet.reading);
      break;
    case PacketType::refuse:
      writer.put(packet.nonce);
      writer.put(static_cast<std::uint32_t>(packet.refusal));
      break;
    case PacketType::reading:
      put_reading(writer, packet.reading);
      break;
    case PacketType::command:
      writer.put(packet.command.sample);
      for (const auto code : packet.command.dac_codes) writer.put(code);
      break;
    case PacketType::close:
      break;
  }
  std::size_t size = writer.size();
  seal(out.first(size));
  if (authenticator != nullptr) {
    const Tag tag = authenticator->tag(out.first(size));
    std::memcpy(out.data() + size, tag.data(), tag.size());
    size += tag.size();
  }
  return size;
}

void seal(std::span<std::byte> packet) noexcept {
  Writer(packet.data() + kChecksumAt).put(checksum(packet));
}

Verdict decode(std::span<const std::byte> datagram, const Authenticator* authenticator, Packet& packet) noexcept {
  if (datagram.size() < kHeaderBytes) return Verdict::too_short;
  if (datagram.size() > kMaxPacketBytes) return Verdict::too_long;
  Reader header(datagram.data());
  if (header.get<std::uint32_t>() != kMagic) return Verdict::wrong_magic;
  if (header.get<std::uint16_t>() != kVersion) return Verdict::wrong_version;
  const auto type = header.get<std::uint8_t>();
  if (!known(type)) return Verdict::unknown_type;
  packet = {};
  packet.type = static_cast<PacketType>(type);
  packet.flags = header.get<std::uint8_t>();
  packet.session = header.get<std::uint64_t>();
  packet.sequence = header.get<std::uint64_t>();
  const std::size_t payload = header.get<std::uint32_t>();
  const auto sum = header.get<std::uint32_t>();
  const bool tagged = (packet.flags & kAuthenticated) != 0;
  const std::size_t body = kHeaderBytes + payload_bytes(packet.type);
  if (payload != payload_bytes(packet.type) || datagram.size() != body + (tagged ? kTagBytes : 0)) {
    return Verdict::wrong_length;
  }
  if (sum != checksum(datagram.first(body))) return Verdict::wrong_checksum;
  if (tagged != (authenticator != nullptr)) return Verdict::not_authenticated;
  if (tagged && !authenticator->verify(datagram.first(body), datagram.subspan(body))) return Verdict::not_authenticated;

  Reader in(datagram.data() + kHeaderBytes);
  switch (packet.type) {
    case PacketType::open:
      packet.nonce = in.get<std::uint64_t>();
      packet.scenario_hash = in.get<std::uint64_t>();
      packet.seed = in.get<std::uint64_t>();
      break;
    case PacketType::accept:
      packet.nonce = in.get<std::uint64_t>();
      packet.scenario_hash = in.get<std::uint64_t>();
      if (!get_reading(in, packet.reading)) return Verdict::impossible_value;
      break;
    case PacketType::refuse: {
      packet.nonce = in.get<std::uint64_t>();
      const auto refusal = in.get<std::uint32_t>();
      if (refusal > static_cast<std::uint32_t>(Refusal::plant)) return Verdict::impossible_value;
      packet.refusal = static_cast<Refusal>(refusal);
      break;
    }
    case PacketType::reading:
      if (!get_reading(in, packet.reading)) return Verdict::impossible_value;
      break;
    case PacketType::command:
      packet.command.sample = in.get<std::uint64_t>();
      for (auto& code : packet.command.dac_codes) code = in.get<std::uint32_t>();
      break;
    case PacketType::close:
      break;
  }
  return Verdict::good;
}

}  // namespace handloop::device::wire
