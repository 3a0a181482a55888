#include "device/wire/packet.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace handloop::device::wire {
namespace {

using Buffer = std::array<std::byte, kMaxPacketBytes>;

Packet example(PacketType type) {
  Packet p;
  p.type = type;
  p.flags = kLockStep;
  p.session = 0x0102030405060708;
  p.sequence = 12345678901;
  switch (type) {
    case PacketType::open:
      p.nonce = 77;
      p.scenario_hash = 88;
      p.seed = 99;
      break;
    case PacketType::accept:
      p.nonce = 77;
      p.scenario_hash = 88;
      [[fallthrough]];
    case PacketType::reading:
      p.reading = {5, 5'000'000, {-1, 2147483647, -2147483647 - 1}, {0, 1, 65535, 4, 5, 6, 7, 4294967295u}, true};
      break;
    case PacketType::refuse:
      p.nonce = 77;
      p.refusal = Refusal::busy;
      break;
    case PacketType::command:
      p.command = {9, {0, 2048, 4095}};
      break;
    case PacketType::close:
      break;
  }
  return p;
}

class EveryType : public testing::TestWithParam<int> {};

TEST_P(EveryType, ComesBackAsItWent) {
  const Packet sent = example(static_cast<PacketType>(GetParam()));
  const Authenticator key("sixteen bytes or more");
  for (const Authenticator* authenticator : {static_cast<const Authenticator*>(nullptr), &key}) {
    Buffer buffer;
    const std::size_t size = encode(sent, authenticator, buffer);
    Packet received;
    ASSERT_EQ(decode(std::span(buffer).first(size), authenticator, received), Verdict::good);
    received.flags &= static_cast<std::uint8_t>(~kAuthenticated);
    EXPECT_EQ(received, sent);
  }
}

TEST_P(EveryType, IsRefusedWhereAnyBitIsWrong) {
  const Packet sent = example(static_cast<PacketType>(GetParam()));
  Buffer buffer;
  const std::size_t size = encode(sent, nullptr, buffer);
  for (std::size_t bit = 0; bit < 8 * size; ++bit) {
    Buffer spoilt = buffer;
    spoilt[bit / 8] ^= std::byte{1} << (bit % 8);
    Packet received;
    EXPECT_NE(decode(std::span(spoilt).first(size), nullptr, received), Verdict::good) << "bit " << bit;
  }
}

TEST_P(EveryType, IsRefusedWhereItIsTooShortOrTooLong) {
  const Packet sent = example(static_cast<PacketType>(GetParam()));
  Buffer buffer{};
  const std::size_t size = encode(sent, nullptr, buffer);
  Packet received;
  for (std::size_t n = 0; n < size; ++n) {
    EXPECT_NE(decode(std::span(buffer).first(n), nullptr, received), Verdict::good) << n;
  }
  EXPECT_EQ(decode(std::span(buffer).first(size + 1), nullptr, received), Verdict::wrong_length);
  const std::vector<std::byte> huge(65000, std::byte{1});
  EXPECT_EQ(decode(huge, nullptr, received), Verdict::too_long);
}

INSTANTIATE_TEST_SUITE_P(Types, EveryType, testing::Range(1, 7));

TEST(Packet, AnotherVersionIsRefusedBeforeAnythingElseIsRead) {
  Buffer buffer;
  const std::size_t size = encode(example(PacketType::open), nullptr, buffer);
  buffer[4] = std::byte{2};
  Packet received;
  EXPECT_EQ(decode(std::span(buffer).first(size), nullptr, received), Verdict::wrong_version);
}

TEST(Packet, BytesAreLittleEndianAtTheirDocumentedPlaces) {
  Buffer buffer;
  ASSERT_EQ(encode(example(PacketType::command), nullptr, buffer), 32u + 8u + 12u);
  EXPECT_EQ(static_cast<char>(buffer[0]), 'H');
  EXPECT_EQ(static_cast<char>(buffer[3]), 'P');
  EXPECT_EQ(buffer[4], std::byte{1});
  EXPECT_EQ(buffer[6], std::byte{5});
  EXPECT_EQ(buffer[8], std::byte{8});    // low byte of the session
  EXPECT_EQ(buffer[24], std::byte{20});  // payload
  EXPECT_EQ(buffer[32 + 8 + 4], std::byte{0});
  EXPECT_EQ(buffer[32 + 8 + 5], std::byte{8});  // DAC code 2048
}

TEST(Packet, ThousandsOfGarbageDatagramsAreRefused) {
  std::mt19937_64 random(20261123);
  const Authenticator key("sixteen bytes or more");
  std::uint64_t good = 0;
  std::vector<std::byte> bytes;
  for (int i = 0; i < 50000; ++i) {
    Buffer buffer{};
    std::size_t size = encode(example(static_cast<PacketType>(1 + random() % 6)), nullptr, buffer);
    if (i % 3 == 0) {
      bytes.resize(random() % 400);
      for (auto& b : bytes) b = static_cast<std::byte>(random());
    } else {
      // A real packet with a few bytes changed and its length cut or stretched.
      bytes.assign(buffer.begin(), buffer.begin() + static_cast<std::ptrdiff_t>(size));
      for (std::size_t k = 0; k <= random() % 4; ++k) {
        auto& b = bytes[random() % bytes.size()];
        b = static_cast<std::byte>(static_cast<unsigned>(b) + 1 + random() % 255);
      }
      if (random() % 2 == 0) bytes.resize(random() % kMaxPacketBytes);
    }
    Packet received;
    good += decode(bytes, nullptr, received) == Verdict::good;
    good += decode(bytes, &key, received) == Verdict::good;
  }
  EXPECT_EQ(good, 0u);
}

}  // namespace
}  // namespace handloop::device::wire
