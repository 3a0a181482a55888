#include <cstdint>
#include <string_view>

#include "device/comedi/comedi_config.h"
#include "device/scales.h"
#include "fuzz/refused.h"

using namespace handloop;

/// A wiring that is accepted has scales that give finite numbers.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  device::comedi::ComediConfig config;
  if (!fuzz::accepted([&] { config = device::comedi::parse_comedi_config(text, "fuzz.toml"); })) return 0;
  const auto description = device::comedi::describe(config, {0.0, 0.0, 0.0}, 1e-3, 4095, 65535);
  fuzz::require(device::joint_angles_rad(description, {1, -1, 1000}).allFinite(), "angles are finite");
  fuzz::require(device::torque_code(description, 0, 0.1) <= 4095, "codes exist");
  return 0;
}
