#include <cstdint>
#include <string>
#include <string_view>

#include "fuzz/refused.h"
#include "io/model_file.h"

using namespace handloop;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  models::AxisModel model;
  if (!fuzz::accepted([&] { model = io::parse_model(text, "fuzz.toml"); })) return 0;
  models::require_valid(model);
  const auto written = io::to_toml(model);
  fuzz::require(io::to_toml(io::parse_model(written, "again.toml")) == written, "what is written is read back");
  return 0;
}
