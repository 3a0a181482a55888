#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "device/device.h"
#include "device/wire/authenticator.h"

/// The wire format between a controller and a plant in another process: UDP datagrams, little-endian, one packet each.
///
///   offset  bytes
///   0       4      magic "HLWP"
///   4       2      version (1)
///   6       1      type
///   7       1      flags: 1 lock-step, 2 authenticated
///   8       8      session: chosen by the plant, 0 in an opening packet
///   16      8      sequence: the sample a reading or command belongs to
///   24      4      bytes of payload
///   28      4      CRC-32 of the packet (this field as 0, without the tag)
///   32      ...    payload, a fixed size for each type
///   ...     32     HMAC-SHA256 tag of everything before, where the session is authenticated
namespace handloop::device::wire {

inline constexpr std::uint16_t kVersion = 1;
inline constexpr std::size_t kHeaderBytes = 32;
inline constexpr std::size_t kMaxPayloadBytes = 128;
inline constexpr std::size_t kMaxPacketBytes = kHeaderBytes + kMaxPayloadBytes + kTagBytes;

enum class PacketType : std::uint8_t {
  open = 1,     ///< controller: nonce, scenario hash, seed
  accept = 2,   ///< plant: the nonce again, scenario hash, reading 0; the session's number in the header
  refuse = 3,   ///< plant: why not
  reading = 4,  ///< plant: encoder counts and ADC codes
  command = 5,  ///< controller: DAC codes
  close = 6     ///< controller: the session is over
};

enum class Refusal : std::uint32_t { none = 0, version = 1, scenario = 2, busy = 3, authentication = 4, plant = 5 };
std::string_view refusal_text(Refusal refusal);

inline constexpr std::uint8_t kLockStep = 1;
inline constexpr std::uint8_t kAuthenticated = 2;

/// A packet in memory. Which members mean something depends on the type.
struct Packet {
  PacketType type = PacketType::close;
  std::uint8_t flags = 0;
  std::uint64_t session = 0;
  std::uint64_t sequence = 0;
  std::uint64_t nonce = 0;          ///< open, accept, refuse
  std::uint64_t scenario_hash = 0;  ///< open, accept
  std::uint64_t seed = 0;           ///< open
  Refusal refusal = Refusal::none;  ///< refuse
  Reading reading;                  ///< reading, accept
  Command command;                  ///< command

  bool operator==(const Packet&) const = default;
};

/// What is wrong with a datagram; `good` where nothing is.
enum class Verdict : std::uint8_t {
  good,
  too_short,
  too_long,
  wrong_magic,
  wrong_version,
  unknown_type,
  wrong_length,
  wrong_checksum,
  not_authenticated,
  impossible_value
};
inline constexpr std::size_t kVerdicts = 10;
std::string_view verdict_name(Verdict verdict);

/// Writes the packet, with a tag where an authenticator is given; returns the bytes used. Real-time safe but for the
/// authenticator's own work.
std::size_t encode(const Packet& packet, const Authenticator* authenticator, std::span<std::byte, kMaxPacketBytes> out);

/// Writes its checksum into the header of a packet without tag, of kHeaderBytes or more. Real-time safe.
void seal(std::span<std::byte> packet) noexcept;

/// Reads a datagram. Trusts nothing: any bytes of any length are safe. With an authenticator, only tagged packets are
/// good; without one, tagged packets are refused. Does not allocate or throw.
Verdict decode(std::span<const std::byte> datagram, const Authenticator* authenticator, Packet& packet) noexcept;

}  // namespace handloop::device::wire
