#include <gtest/gtest.h>

#include <chrono>
#include <fstream>
#include <random>

#include "models/errors.h"
#include "tests/device/wire/relay.h"
#include "tests/device/wire/served_plant.h"

namespace handloop::device::wire {
namespace {

using namespace std::chrono_literals;

std::vector<StepRecord> locally(int steps) {
  FakePlant plant;
  return run_wall(plant, steps);
}

TEST(Wire, LockStepGivesTheSameBitsAsThePlantItself) {
  ServedPlant served;
  WireDevice device(FakePlant().description(), to(served.address()));
  EXPECT_TRUE(same_bits(run_wall(device, 2000), locally(2000)));
  EXPECT_EQ(device.counters().refused(), 0u);
}

TEST(Wire, EverySessionStartsThePlantAfresh) {
  ServedPlant served;
  WireDevice device(FakePlant().description(), to(served.address()));
  const auto first = run_wall(device, 300), second = run_wall(device, 300);
  EXPECT_TRUE(same_bits(first, second));
  served.end();
  EXPECT_EQ(served.sessions(), 2u);
}

TEST(Wire, LostDoubledReorderedAndSpoiltPacketsChangeNothingInLockStep) {
  ServedPlant served;
  std::mt19937 random(7);
  std::deque<Bytes> kept;
  Relay relay(served.address(), [&](const Bytes& datagram, bool) -> std::vector<Bytes> {
    switch (random() % 12) {
      case 0:
        return {};  // lost
      case 1:
        return {datagram, datagram};
      case 2:
        kept.push_back(datagram);  // comes after the next
        return {};
      case 3: {
        Bytes spoilt = datagram;
        spoilt[random() % spoilt.size()] ^= std::byte{0x40};
        return {spoilt};
      }
      case 4:
        return {datagram, Bytes(random() % 600, std::byte{0x5a})};
      default: {
        std::vector<Bytes> out{datagram};
        out.insert(out.end(), kept.begin(), kept.end());
        kept.clear();
        return out;
      }
    }
  });
  auto options = to(relay.address());
  options.patience_ms = 5000;
  WireDevice device(FakePlant().description(), std::move(options));
  EXPECT_TRUE(same_bits(run_wall(device, 400), locally(400)));
  const Counters& counted = device.counters();
  EXPECT_GT(counted.sent_again, 10u);
  EXPECT_GT(counted.doubled + counted.reordered, 5u);
  EXPECT_GT(counted.by_verdict[static_cast<std::size_t>(Verdict::wrong_checksum)], 0u);
  served.end();
  EXPECT_GT(served.counters().refused(), 5u);
}

TEST(Wire, WithAKeyTheLogIsStillTheSame) {
  ServedPlant served(true);
  WireDevice device(FakePlant().description(), to(served.address(), true));
  EXPECT_TRUE(same_bits(run_wall(device, 500), locally(500)));
}

TEST(Wire, WhoComesWithoutTheKeyIsRefused) {
  ServedPlant served(true);
  WireDevice device(FakePlant().description(), to(served.address()));
  try {
    device.start();
    FAIL() << "a session without a key was opened";
  } catch (const RequirementError& error) {
    EXPECT_NE(std::string(error.what()).find("--key"), std::string::npos) << error.what();
  }
}

TEST(Wire, WhoComesWithAnotherKeyGetsNoAnswer) {
  ServedPlant served(true);
  auto options = to(served.address());
  options.key.emplace("another key of sixteen bytes");
  options.patience_ms = 250;
  WireDevice device(FakePlant().description(), std::move(options));
  EXPECT_THROW(device.start(), RequirementError);
  served.end();
  EXPECT_EQ(served.sessions(), 0u);
  EXPECT_GT(served.counters().by_verdict[static_cast<std::size_t>(Verdict::not_authenticated)], 0u);
}

TEST(Wire, AnotherScenarioIsRefusedByName) {
  ServedPlant served;
  auto options = to(served.address());
  options.scenario_hash ^= 1;
  WireDevice device(FakePlant().description(), std::move(options));
  try {
    device.start();
    FAIL();
  } catch (const RequirementError& error) {
    EXPECT_NE(std::string(error.what()).find("another scenario"), std::string::npos) << error.what();
  }
}

TEST(Wire, ASecondControllerIsToldThatThePlantIsHeld) {
  ServedPlant served;
  WireDevice first(FakePlant().description(), to(served.address()));
  first.start();
  auto options = to(served.address());
  options.patience_ms = 250;
  WireDevice second(FakePlant().description(), std::move(options));
  try {
    second.start();
    FAIL();
  } catch (const RequirementError& error) {
    EXPECT_NE(std::string(error.what()).find("held"), std::string::npos) << error.what();
  }
  EXPECT_TRUE(first.read().valid);
}

TEST(Wire, ThePlantOfAControllerThatVanishedIsFreeAgain) {
  ServedPlant served(false, 0.2);
  {
    auto options = to(served.address());
    WireDevice vanishing(FakePlant().description(), std::move(options));
    vanishing.start();
    WireDevice next(FakePlant().description(), to(served.address()));
    EXPECT_NO_THROW(next.start());  // waits until the first is given up
  }
}

TEST(Wire, NobodyThereIsSaidSo) {
  WireOptions options = to(parse_address("127.0.0.1:9", "test"));
  options.patience_ms = 200;
  WireDevice device(FakePlant().description(), std::move(options));
  try {
    device.start();
    FAIL();
  } catch (const RequirementError& error) {
    EXPECT_NE(std::string(error.what()).find("no plant answers"), std::string::npos);
  }
}

TEST(Wire, PacketsOfAnOldSessionMeanNothingInANewOne) {
  ServedPlant served(true, 0.3);
  std::vector<Bytes> recorded;
  {
    Relay relay(served.address(), [](const Bytes& datagram, bool) { return std::vector<Bytes>{datagram}; });
    WireDevice device(FakePlant().description(), to(relay.address(), true));
    run_wall(device, 50);
    std::this_thread::sleep_for(50ms);  // the closing packets are on their way
    relay.end();
    recorded = relay.seen();
  }
  ASSERT_GT(recorded.size(), 50u);
  // All that was said before is said again, from the same end point as the new session.
  std::size_t at = 0;
  Relay relay(served.address(), [&](const Bytes& datagram, bool to_plant) {
    std::vector<Bytes> out{datagram};
    if (to_plant && at < recorded.size()) out.push_back(recorded[at++]);
    return out;
  });
  WireDevice device(FakePlant().description(), to(relay.address(), true));
  EXPECT_TRUE(same_bits(run_wall(device, 200), locally(200)));
  served.end();
  EXPECT_GT(served.counters().wrong_session, 40u);
}

TEST(Wire, InRealTimeThePlantZeroesItsMotorsTwentySamplesAfterTheControllerFellSilent) {
  ServedPlant served;
  auto options = to(served.address());
  options.lock_step = false;
  WireDevice device(FakePlant().description(), std::move(options));
  device.start();
  Command push;
  push.dac_codes.fill(zero_code(device.description()));
  push.dac_codes[0] = 2400;
  // The reading shows what the plant does: it keeps moving while the force is there.
  for (int i = 0; i < 10; ++i) {
    device.read();
    device.write(push);
    std::this_thread::sleep_for(1ms);
  }
  std::this_thread::sleep_for(150ms);
  served.end();
  EXPECT_EQ(served.counters().silences, 1u);
}

TEST(Wire, AddressesAreUnderstoodAndLoopbackIsTheDefault) {
  EXPECT_TRUE(parse_address("47113", "--listen").loopback());
  EXPECT_TRUE(parse_address(":47113", "--listen").loopback());
  EXPECT_TRUE(parse_address("[::1]:47113", "--listen").loopback());
  EXPECT_FALSE(parse_address("0.0.0.0:47113", "--listen").loopback());
  EXPECT_EQ(parse_address("127.0.0.1:47113", "--listen").text(), "127.0.0.1:47113");
  for (const char* wrong : {"", "127.0.0.1:", "127.0.0.1:x", "127.0.0.1:70000", "[::1", "no.such.host.invalid:1"}) {
    EXPECT_THROW(parse_address(wrong, "--listen"), InputError) << wrong;
  }
}

TEST(Wire, KeysMustBeLongEnough) {
  EXPECT_THROW(Authenticator("short"), InputError);
  EXPECT_THROW(read_key_file("/does/not/exist"), InputError);
  const Authenticator a("0123456789abcdef"), b("0123456789abcdeg");
  const std::array<std::byte, 3> text{std::byte{1}, std::byte{2}, std::byte{3}};
  EXPECT_TRUE(a.verify(text, a.tag(text)));
  EXPECT_TRUE(a.verify(text, a.tag(text)));  // the context may be used again
  EXPECT_FALSE(b.verify(text, a.tag(text)));
}

TEST(Wire, TagsAreHmacSha256) {
  // RFC 4231, test case 3: key 20 bytes 0xaa, data 50 bytes 0xdd.
  const Authenticator authenticator(std::string(20, '\xaa'));
  const std::vector<std::byte> data(50, std::byte{0xdd});
  const Tag tag = authenticator.tag(data);
  constexpr std::array<unsigned char, 8> kBegin{0x77, 0x3e, 0xa9, 0x1e, 0x36, 0x80, 0x0e, 0x46};
  for (std::size_t i = 0; i < kBegin.size(); ++i) EXPECT_EQ(static_cast<unsigned char>(tag[i]), kBegin[i]);
}

}  // namespace
}  // namespace handloop::device::wire
