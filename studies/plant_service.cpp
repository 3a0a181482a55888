#include "studies/plant_service.h"

#include "device/open_device.h"
#include "device/seven_bar_device.h"
#include "device/wire/plant_server.h"

namespace handloop::studies {

PlantServiceOutcome serve_plant(const PlantServiceOptions& options) {
  const models::Scenario scenario = options.scenario;
  device::make_simulated_device(scenario);  // what cannot be simulated is said now, not to the first controller
  device::wire::ServerOptions server_options;
  server_options.listen = device::wire::parse_address(options.listen, "--listen");
  server_options.scenario_hash = device::plant_hash(scenario);
  server_options.silence_samples = scenario.safety.watchdog_samples;
  if (options.key) server_options.key.emplace(device::wire::read_key_file(*options.key));
  device::wire::PlantServer server(std::move(server_options), [scenario](std::uint64_t seed) {
    models::Scenario seeded = scenario;
    seeded.run.seed = seed;
    return device::make_simulated_device(seeded);
  });
  if (options.on_ready) options.on_ready(server.address().text(), server.address().loopback());
  static const std::atomic<bool> kNever{false};
  server.serve(options.stop != nullptr ? *options.stop : kNever);
  return {server.sessions(), server.counters()};
}

}  // namespace handloop::studies
