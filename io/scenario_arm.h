#pragma once

#include <filesystem>
#include <string>

#include "io/toml_table.h"
#include "models/scenario.h"

/// The arms of a scenario file: [arm.x], [arm.y], [arm.z] and [[arm.effect]].
namespace handloop::io::detail {

/// Reads them from the table [arm] into the settings. Throws InputError naming file, line and key.
void read_arms(const TomlTable& arm, const std::filesystem::path& folder, models::ArmSettings& settings);

std::string arms_to_toml(const models::ArmSettings& settings);

}  // namespace handloop::io::detail
