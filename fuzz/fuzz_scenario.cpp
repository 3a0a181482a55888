#include <cstdint>
#include <string>
#include <string_view>

#include "fuzz/refused.h"
#include "io/scenario_file.h"

using namespace handloop;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  models::Scenario scenario;
  if (!fuzz::accepted([&] { scenario = io::parse_scenario(text, "fuzz.toml", "/nowhere"); })) return 0;
  const auto written = io::to_toml(scenario);
  fuzz::require(io::to_toml(io::parse_scenario(written, "again.toml")) == written, "what is written is read back");
  return 0;
}
