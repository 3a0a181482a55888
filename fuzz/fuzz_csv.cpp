#include <cmath>
#include <cstdint>
#include <string_view>

#include "fuzz/refused.h"
#include "io/recording_file.h"

using namespace handloop;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  for (const bool by_number : {false, true}) {
    io::RecordingOptions options;
    options.minimum_rows = 3;
    if (by_number) {
      options.force = "1";
      options.position = "2";
      options.rate_Hz = 1000;
    }
    models::Recording recording;
    if (!fuzz::accepted([&] { recording = io::parse_recording(text, "fuzz.csv", options); })) continue;
    fuzz::require(recording.size() >= 3 && recording.position_m.size() == recording.size(), "channels of one length");
    fuzz::require(recording.sample_time_s > 0 && std::isfinite(recording.sample_time_s), "a sample time");
    for (std::size_t i = 0; i < recording.size(); ++i) {
      fuzz::require(std::isfinite(recording.force_N[i]) && std::isfinite(recording.position_m[i]), "finite samples");
    }
  }
  return 0;
}
