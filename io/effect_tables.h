#pragma once

#include <string>

#include "io/toml_table.h"
#include "models/effects/effect.h"

namespace handloop::io {

/// Reads one [[effect]] table: name, acts_on (the effect's usual place where absent) and effect.parameters. `more_keys`
/// are allowed beside these. Throws InputError naming file, line and key.
models::EffectPtr read_effect(const TomlTable& table, std::initializer_list<std::string_view> more_keys = {});

/// The same as TOML; `table_name` is "effect" in a model file. `more_lines` stand after acts_on.
std::string effect_to_toml(const models::Effect& effect, std::string_view table_name = "effect",
                           std::string_view more_lines = "");

}  // namespace handloop::io
