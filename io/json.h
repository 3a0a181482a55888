#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

/// JSON as CONTRACT writes it. Include <nlohmann/json.hpp> to build the values.
namespace handloop::io {

/// A number, "inf" or "-inf" for infinity, null for NaN (JSON knows neither).
nlohmann::ordered_json json_number(double value);

/// Indented, to a file whole or not at all, or to standard output where the name is "-". Throws InputError where it
/// cannot be written.
void write_json(const nlohmann::ordered_json& json, const std::string& target);

}  // namespace handloop::io
