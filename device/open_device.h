#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "device/device.h"
#include "models/scenario.h"

namespace handloop::device {

struct OpenOptions {
  models::Scenario scenario;  ///< its run.seed seeds the plant
  bool realtime = false;      ///< udp: the plant keeps its own time
  std::optional<std::filesystem::path> key{};
};

/// Device by its address: "sim", "udp://HOST:PORT", "replay:FILE", "comedi" (boards as in docs/hardware.md) or
/// "comedi:FILE.toml". Not started yet. Throws InputError for anything else, or where it cannot be made.
std::unique_ptr<Device> open_device(const std::string& address, const OpenOptions& options);

/// Names what a plant simulates: scenarios that differ only in what the controller does, how long it runs and with
/// which seed have the same number.
std::uint64_t plant_hash(models::Scenario scenario);

}  // namespace handloop::device
