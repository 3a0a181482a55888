#include "cli/scenario_argument.h"

#include <filesystem>

#include "io/scenario_file.h"
#include "sim/scene_file.h"

namespace handloop::cli {
namespace fs = std::filesystem;

models::Scenario read_scenario_argument(const std::string& given) {
  const fs::path path = given.empty() ? "scenes/phantom_wall.toml" : given;
  if (!fs::exists(path) && (!path.has_parent_path() || path.parent_path().filename() == "scenes")) {
    auto ours = sim::scenes_directory() / path.filename();
    if (!ours.has_extension()) ours += ".toml";
    if (fs::exists(ours)) return io::read_scenario(ours);
  }
  return io::read_scenario(path);
}

}  // namespace handloop::cli
