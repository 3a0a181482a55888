#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "device/wire/counters.h"
#include "models/scenario.h"

namespace handloop::studies {

struct PlantServiceOptions {
  models::Scenario scenario;
  std::string listen;  ///< HOST:PORT; loopback where no host is given
  std::optional<std::filesystem::path> key{};
  const std::atomic<bool>* stop = nullptr;
  std::function<void(const std::string& address, bool loopback)> on_ready{};  ///< port and address are open
};

struct PlantServiceOutcome {
  std::uint64_t sessions = 0;
  device::wire::Counters counters;
};

/// Serves the simulated device of a scenario to controllers in other processes until stopped. Each session starts the
/// plant afresh with the controller's seed. Throws InputError where the scenario, the address or the key cannot be
/// used.
PlantServiceOutcome serve_plant(const PlantServiceOptions& options);

}  // namespace handloop::studies
