// What one pass of the haptic loop costs, and how the wire stands a million bad packets.
#include <benchmark/benchmark.h>

#include <random>

#include "control/controllers/phantom_mechanism.h"
#include "control/controllers/virtual_wall.h"
#include "device/latency.h"
#include "device/live_loop.h"
#include "device/sim_device.h"
#include "device/wire/packet.h"
#include "io/scenario_file.h"

namespace handloop::device {
namespace {

void loop_step(benchmark::State& state) {
  const auto scenario = io::default_scenario();
  SimDevice plant(scenario);
  const auto mechanism = control::make_mechanism(scenario.device);
  const Eigen::Vector3d home = mechanism->at(pose_rad(scenario)).tip_m;
  auto wall = control::make_virtual_wall(scenario, home);
  Loop loop(loop_config(scenario, home), plant.description(), *mechanism, wall);
  plant.start();
  LatencyHistogram own;
  for (auto _ : state) own.add(loop.step(plant).compute_ns);
  // The pass without the plant: the budget is p99.9 under 50 us.
  state.counters["p50_us"] = own.percentile_us(0.5);
  state.counters["p99_us"] = own.percentile_us(0.99);
  state.counters["p99_9_us"] = own.percentile_us(0.999);
  state.counters["max_us"] = own.max_us();
}
BENCHMARK(loop_step)->Iterations(100'000)->Unit(benchmark::kMicrosecond);

void a_million_bad_packets(benchmark::State& state) {
  const wire::Authenticator key("sixteen bytes or more");
  const bool with_key = state.range(0) != 0;
  std::mt19937_64 random(1);
  std::array<std::byte, wire::kMaxPacketBytes> good{};
  wire::Packet packet;
  packet.type = wire::PacketType::command;
  const std::size_t size = wire::encode(packet, with_key ? &key : nullptr, good);
  std::uint64_t accepted = 0;
  for (auto _ : state) {
    auto bad = good;
    const std::size_t at = random() % size;
    bad[at] ^= static_cast<std::byte>(1 + random() % 255);
    const std::size_t length = random() % 4 == 0 ? random() % wire::kMaxPacketBytes : size;
    accepted += wire::decode(std::span(bad).first(length), with_key ? &key : nullptr, packet) == wire::Verdict::good;
  }
  state.counters["accepted"] = static_cast<double>(accepted);
  if (accepted > 0) state.SkipWithError("a bad packet was accepted");
}
BENCHMARK(a_million_bad_packets)->Arg(0)->Arg(1)->Iterations(1'000'000);

}  // namespace
}  // namespace handloop::device

BENCHMARK_MAIN();
