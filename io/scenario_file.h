#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "models/scenario.h"

/// Scenario files: TOML that says what is simulated or run. Every key has a default; docs/scenarios.md lists them all.
namespace handloop::io {

/// Arms may refer to model files, which are looked for beside the scenario. Throws InputError naming file, line and
/// key: TOML errors, unknown keys (with the nearest known one, in whatever table it belongs), values of the wrong kind
/// or out of range.
models::Scenario read_scenario(const std::filesystem::path& path);
/// The same from text; `name` stands for the file in messages, `folder` is where model files are looked for.
models::Scenario parse_scenario(std::string_view text, const std::string& name,
                                const std::filesystem::path& folder = ".");

/// The scenario where a file says nothing: the nominal arm on the Phantom, and the defaults of models/scenario.h.
models::Scenario default_scenario();

/// Every key with its value, arms by their numbers: a file that parse_scenario reads back to the same bits. Equal
/// scenarios give equal text, so that a hash of it names the scenario.
std::string to_toml(const models::Scenario& scenario);

/// One key of a scenario file, for documentation and completion.
struct ScenarioKey {
  std::string table;  ///< "" for the top of the file
  std::string name;
  std::string initial;  ///< default, as TOML
  std::string values;   ///< "0 to 1", "true or false", "grip, flange"
  std::string meaning;
};
/// Plain keys of every table, in the order of the file; those that describe arms and effects are not among them.
std::vector<ScenarioKey> scenario_keys();
/// The list of keys as it stands in docs/scenarios.md.
std::string scenario_keys_markdown();

}  // namespace handloop::io
