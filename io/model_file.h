#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "models/axis_model.h"

/// Model files: one axis of a plant as TOML, a base model (`arm5` or `msd`) and the effects added to it.
/// docs/file-formats.md describes every key.
namespace handloop::io {

/// Throws InputError naming the file, the line and the key: TOML errors, unknown keys, effects and parameters (with the
/// nearest known word), values of the wrong kind or out of bounds.
models::AxisModel read_model(const std::filesystem::path& path);
/// The same from text; `name` stands for the file in messages.
models::AxisModel parse_model(std::string_view text, const std::string& name);

/// A file that parse_model reads back to the same bits.
std::string to_toml(const models::AxisModel& model);
/// Writes the file whole or not at all.
void write_model(const std::filesystem::path& path, const models::AxisModel& model);

}  // namespace handloop::io
