#pragma once

#include <atomic>
#include <memory>
#include <thread>
#include <vector>

#include "control/controllers/virtual_wall.h"
#include "device/wire/plant_server.h"
#include "device/wire/wire_device.h"
#include "tests/device/fake_plant.h"

namespace handloop::device::wire {

inline constexpr std::uint64_t kScenario = 0x1234567890abcdef;
inline constexpr std::string_view kKey = "a key of more than sixteen bytes";

/// A fake plant behind a server in a thread of its own.
class ServedPlant {
 public:
  explicit ServedPlant(bool with_key = false, double idle_s = 2.0)
      : server_(options(with_key, idle_s),
                [this](std::uint64_t) {
                  auto plant = std::make_unique<FakePlant>();
                  plant_ = plant.get();
                  return plant;
                }),
        thread_([this] { server_.serve(stop_); }) {}
  ~ServedPlant() { end(); }

  void end() {
    stop_ = true;
    if (thread_.joinable()) thread_.join();
  }
  Address address() const { return server_.address(); }
  /// After end().
  const Counters& counters() const { return server_.counters(); }
  std::uint64_t sessions() const { return server_.sessions(); }

 private:
  static ServerOptions options(bool with_key, double idle_s) {
    ServerOptions options;
    options.listen = parse_address("127.0.0.1:0", "test");
    options.scenario_hash = kScenario;
    options.idle_s = idle_s;
    if (with_key) options.key.emplace(kKey);
    return options;
  }
  std::atomic<FakePlant*> plant_{nullptr};
  std::atomic<bool> stop_{false};
  PlantServer server_;
  std::thread thread_;
};

inline WireOptions to(const Address& address, bool with_key = false) {
  WireOptions options;
  options.plant = address;
  options.scenario_hash = kScenario;
  if (with_key) options.key.emplace(kKey);
  return options;
}

/// Runs a wall on a device for some samples.
inline std::vector<StepRecord> run_wall(Device& device, int steps) {
  control::VirtualWall::Settings settings;
  settings.plane_m = 0.002;
  settings.gains = {500.0, 1.0, 100.0};
  control::VirtualWall wall(settings);
  FakeMechanism mechanism;
  Loop loop({}, device.description(), mechanism, wall);
  std::vector<StepRecord> records;
  device.start();
  for (int i = 0; i < steps; ++i) records.push_back(loop.step(device));
  device.stop();
  return records;
}

inline bool same_bits(const std::vector<StepRecord>& a, const std::vector<StepRecord>& b) {
  if (a.size() != b.size()) return false;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (!(a[i].reading == b[i].reading && a[i].command == b[i].command && a[i].energy_J == b[i].energy_J)) return false;
  }
  return true;
}

}  // namespace handloop::device::wire
