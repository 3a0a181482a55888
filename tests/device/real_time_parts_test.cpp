#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <thread>
#include <vector>

#include "control/controllers/phantom_mechanism.h"
#include "control/controllers/virtual_wall.h"
#include "device/black_box.h"
#include "device/latency.h"
#include "device/log_file.h"
#include "device/loop.h"
#include "device/mailbox.h"
#include "device/ring_buffer.h"
#include "tests/device/fake_plant.h"
#include "tests/heap_counter/heap_counter.h"

namespace handloop::device {
namespace {

/// 3000 samples, the last 500 after a fault; what they take from the heap.
std::size_t allocations_of_a_loop(FakePlant& plant, const control::Mechanism& mechanism) {
  control::VirtualWall::Settings settings;
  settings.plane_m = mechanism.at(Eigen::Vector3d::Zero()).tip_m[0] + 0.002;
  control::VirtualWall wall(settings);
  LoopConfig config;
  config.limits.home_tip_m = mechanism.at(Eigen::Vector3d::Zero()).tip_m;
  Loop loop(config, plant.description(), mechanism, wall);
  RingBuffer<StepRecord, 4096> ring;
  BlackBox box(2.0, 1e-3);
  LatencyHistogram histogram;
  char row[kMaxRow];
  plant.start();
  std::size_t characters = 0;
  const std::size_t allocations = test::heap_allocations_of([&] {
    for (int i = 0; i < 3000; ++i) {
      if (i == 2500) loop.trip(Fault::external);
      const StepRecord& record = loop.step(plant);
      box.add(record);
      ring.push(record);
      histogram.add(record.compute_ns);
      characters += format_row(record, {}, row);
    }
  });
  EXPECT_EQ(loop.fault().fault, Fault::external);
  EXPECT_GT(characters, 0u);
  return allocations;
}

TEST(RealTime, TheLoopTakesNothingFromTheHeap) {
  FakePlant plant;
  plant.sway_N = 1.5;
  EXPECT_EQ(allocations_of_a_loop(plant, FakeMechanism()), 0u);
  plant.settings().recorded = true;  // it does not move as a Phantom would
  EXPECT_EQ(allocations_of_a_loop(plant, *control::make_mechanism({})), 0u);
  EXPECT_GE(test::heap_allocations_of([] { std::vector<int>(100).at(5) = 1; }), 1u);
}

TEST(RingBuffer, GivesBackWhatWasPutInAndRefusesWhenFull) {
  RingBuffer<int, 8> ring;
  int value = 0;
  EXPECT_FALSE(ring.pop(value));
  for (int i = 0; i < 8; ++i) EXPECT_TRUE(ring.push(i));
  EXPECT_FALSE(ring.push(99));
  EXPECT_EQ(ring.lost(), 1u);
  for (int i = 0; i < 8; ++i) {
    ASSERT_TRUE(ring.pop(value));
    EXPECT_EQ(value, i);
  }
  EXPECT_FALSE(ring.pop(value));
}

TEST(RingBuffer, KeepsOrderAndEveryValueBetweenTwoThreads) {
  RingBuffer<std::array<std::uint64_t, 4>, 256> ring;
  constexpr std::uint64_t kValues = 200000;
  std::thread producer([&] {
    for (std::uint64_t i = 0; i < kValues;) {
      if (ring.push({i, ~i, i * 3, i ^ 0x5555})) {
        ++i;
      } else {
        std::this_thread::yield();
      }
    }
  });
  std::array<std::uint64_t, 4> value{};
  for (std::uint64_t i = 0; i < kValues;) {
    if (!ring.pop(value)) {
      std::this_thread::yield();
      continue;
    }
    ASSERT_EQ(value[0], i);
    ASSERT_EQ(value[1], ~i);
    ASSERT_EQ(value[3], i ^ 0x5555);
    ++i;
  }
  producer.join();
}

TEST(Mailbox, HoldsTheLatestAndNeverHalfOfTwo) {
  Mailbox<std::array<std::uint64_t, 8>> mailbox;
  std::array<std::uint64_t, 8> value{};
  EXPECT_FALSE(mailbox.take(value));
  constexpr std::uint64_t kPosts = 200000;
  std::thread poster([&] {
    std::array<std::uint64_t, 8> posted;
    for (std::uint64_t i = 1; i <= kPosts; ++i) {
      posted.fill(i);
      mailbox.post(posted);
    }
  });
  std::uint64_t last = 0;
  while (last < kPosts) {
    if (!mailbox.take(value)) {
      std::this_thread::yield();
      continue;
    }
    ASSERT_GT(value[0], last);
    for (const auto part : value) ASSERT_EQ(part, value[0]);
    last = value[0];
  }
  poster.join();
  EXPECT_FALSE(mailbox.take(value));
}

TEST(Latency, PercentilesAreThoseOfTheSortedValuesToWithinAClass) {
  std::mt19937 random(3);
  std::lognormal_distribution<double> duration(9.0, 1.5);
  std::vector<double> values;
  LatencyHistogram histogram;
  for (int i = 0; i < 50000; ++i) {
    const auto ns = static_cast<std::int64_t>(duration(random));
    values.push_back(static_cast<double>(ns) * 1e-3);
    histogram.add(ns);
  }
  std::sort(values.begin(), values.end());
  for (const double share : {0.01, 0.5, 0.9, 0.99, 0.999}) {
    const double truth = values[static_cast<std::size_t>(std::ceil(share * 50000)) - 1];
    // A class is 1/32 of its octave's lower end: 3.2 % at most, and the reported end is the upper one.
    EXPECT_GE(histogram.percentile_us(share), truth * (1 - 1e-12));
    EXPECT_LE(histogram.percentile_us(share), truth * 1.033 + 0.001);
  }
  EXPECT_EQ(histogram.percentile_us(1.0), values.back());
  EXPECT_EQ(histogram.max_us(), values.back());
}

TEST(Latency, TakesAnyDuration) {
  LatencyHistogram histogram;
  EXPECT_EQ(histogram.percentile_us(0.5), 0.0);
  for (const std::int64_t ns : {std::int64_t{-5}, std::int64_t{0}, std::int64_t{1}, std::int64_t{31}, std::int64_t{32},
                                std::numeric_limits<std::int64_t>::max()}) {
    histogram.add(ns);
  }
  EXPECT_EQ(histogram.count(), 6u);
}

TEST(BlackBox, HoldsTheLastSecondsInOrder) {
  BlackBox box(2.0, 1e-3);
  StepRecord record;
  for (std::uint64_t i = 0; i < 5000; ++i) {
    record.step = i;
    box.add(record);
  }
  ASSERT_EQ(box.size(), 2001u);
  for (std::size_t i = 0; i < box.size(); ++i) EXPECT_EQ(box[i].step, 2999 + i);
}

}  // namespace
}  // namespace handloop::device
