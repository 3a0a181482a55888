/// Writes planted recordings as CSV, with the truth beside them, so that `handloop explain` can be tried on them by
/// hand:
///   make_recordings DIR [--count N] [--seed S] [--what NAME]
/// DIR/rec_000.csv ... and DIR/truth.csv. Without --what the set is stratified (clean, one effect, two, outsiders,
/// axes).
#include <cstdio>
#include <cstring>
#include <exception>
#include <filesystem>
#include <fstream>
#include <string>

#include "tests/support/exam.h"
#include "tests/support/planted_recording.h"

using handloop::tests::PlantedRecording;

namespace {

std::string values(const std::map<std::string, double>& map) {
  std::string text;
  for (const auto& [name, value] : map) {
    char number[40];
    std::snprintf(number, sizeof number, "%.6g", value);
    text += (text.empty() ? "" : ";") + name + "=" + number;
  }
  return text;
}

}  // namespace

int main(int argc, char** argv) {
  std::string directory, what;
  std::size_t count = 10;
  std::uint64_t seed = 1;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--count" && i + 1 < argc)
      count = std::stoul(argv[++i]);
    else if (word == "--seed" && i + 1 < argc)
      seed = std::stoull(argv[++i]);
    else if (word == "--what" && i + 1 < argc)
      what = argv[++i];
    else
      directory = word;
  }
  if (directory.empty()) {
    std::fprintf(stderr, "usage: make_recordings DIR [--count N] [--seed S] [--what NAME]\n");
    return 2;
  }
  try {
    std::filesystem::create_directories(directory);
    std::ofstream truth(std::filesystem::path(directory) / "truth.csv");
    truth << "file,group,base,driven_by,rotary,truth,variant,parameters,base_parameters,rmse_floor,rmse_base,ratio,"
             "noise_rms,"
             "wander_rms,hold\n";
    for (std::size_t i = 0; i < count; ++i) {
      const PlantedRecording r = what.empty() ? handloop::tests::plant_stratified(i, seed)
                                              : handloop::tests::plant_recording(what, seed * 7919 + i);
      char name[32];
      std::snprintf(name, sizeof name, "rec_%03zu.csv", i);
      handloop::tests::write_recording_csv(std::filesystem::path(directory) / name, r);
      std::string variants, parameters;
      for (const auto& effect : r.truth) {
        variants += (variants.empty() ? "" : " + ") + effect.variant;
        parameters += (parameters.empty() ? "" : " + ") + values(effect.parameters);
      }
      truth << name << ',' << group_name(r.group) << ',' << r.base << ',' << r.driven_by << ',' << r.rotary << ','
            << r.truth_names() << ",\"" << variants << "\",\"" << parameters << "\"," << values(r.base_parameters)
            << ',' << r.rmse_floor << ',' << r.rmse_base << ',' << r.ratio() << ',' << r.noise_rms << ','
            << r.wander_rms << ',' << r.hold << '\n'
            << std::flush;
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "make_recordings: %s\n", error.what());
    return 1;
  }
}
