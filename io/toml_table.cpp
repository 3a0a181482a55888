#include "io/toml_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "models/errors.h"
#include "models/suggest.h"

namespace handloop::io {
namespace {

std::string_view kind_name(const toml::node& node) {
  switch (node.type()) {
    case toml::node_type::table:
      return "a table";
    case toml::node_type::array:
      return "an array";
    case toml::node_type::string:
      return "text";
    case toml::node_type::integer:
      return "a whole number";
    case toml::node_type::floating_point:
      return "a number";
    case toml::node_type::boolean:
      return "true or false";
    default:
      return "a date or time";
  }
}

/// One line, whatever the parser says.
std::string first_line(std::string_view text) {
  return std::string(text.substr(0, text.find_first_of("\r\n")));
}

}  // namespace

toml::table parse_toml(std::string_view text, const std::string& name) {
  try {
    return toml::parse(text, name);
  } catch (const toml::parse_error& error) {
    const auto at = error.source().begin;
    throw InputError(fmt::format("{}, line {}, column {}: not valid TOML: {}", name, at.line, at.column,
                                 first_line(error.description())));
  }
}

std::string toml_number(double value) {
  auto text = fmt::format("{}", value);
  if (text.find_first_of(".en") == std::string::npos) text += ".0";
  return text;
}

std::string toml_text(std::string_view text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      quoted += '\\';
      quoted += c;
    } else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) {
      quoted += fmt::format("\\u{:04X}", static_cast<unsigned>(static_cast<unsigned char>(c)));
    } else {
      quoted += c;
    }
  }
  return quoted + '"';
}

TomlTable::TomlTable(const toml::table& table, std::string file, std::string path)
    : table_(&table), file_(std::move(file)), path_(std::move(path)) {}

std::vector<std::string_view> TomlTable::keys() const {
  std::vector<std::string_view> keys;
  for (const auto& [key, node] : *table_) keys.push_back(key.str());
  return keys;
}

std::string TomlTable::place(const toml::node* node) const {
  const auto line = node != nullptr ? node->source().begin.line : table_->source().begin.line;
  return fmt::format("{}, line {}: {}", file_, std::max<unsigned>(line, 1),
                     path_.empty() ? "" : fmt::format("[{}] ", path_));
}

void TomlTable::fail(std::string_view key, std::string_view message) const {
  throw InputError(fmt::format("{}{}: {}", place(table_->get(key)), key, message));
}

void TomlTable::fail(std::string_view message) const {
  throw InputError(place(nullptr) + std::string(message));
}

std::string_view TomlTable::first_unknown(std::span<const std::string_view> keys) const {
  // The first in the file, not in the alphabet.
  const toml::node* first = nullptr;
  std::string_view unknown;
  for (const auto& [key, node] : *table_) {
    if (std::find(keys.begin(), keys.end(), key.str()) != keys.end()) continue;
    if (first == nullptr || node.source().begin.line < first->source().begin.line) {
      first = &node;
      unknown = key.str();
    }
  }
  return unknown;
}

void TomlTable::fail_unknown(std::string_view key, std::string_view hint) const {
  const auto* node = table_->get(key);
  throw InputError(fmt::format("{}unknown {} '{}'{}", place(node),
                               node != nullptr && node->is_table() ? "table" : "key", key, hint));
}

void TomlTable::allow_only(std::span<const std::string_view> keys) const {
  const auto unknown = first_unknown(keys);
  if (!unknown.empty()) fail_unknown(unknown, suggestion(unknown, keys));
}

std::optional<double> TomlTable::number(std::string_view key) const {
  const auto* node = table_->get(key);
  if (node == nullptr) return std::nullopt;
  if (!node->is_number()) fail(key, fmt::format("expected a number, not {}", kind_name(*node)));
  const double value = *node->value<double>();
  if (!std::isfinite(value)) fail(key, fmt::format("is {}, but must be finite", value));
  return value;
}

std::optional<std::int64_t> TomlTable::integer(std::string_view key) const {
  const auto* node = table_->get(key);
  if (node == nullptr) return std::nullopt;
  const auto value = number(key);
  if (node->is_integer()) return node->as_integer()->get();
  if (*value != std::floor(*value) || std::abs(*value) > 9e15)
    fail(key, fmt::format("is {}, but must be whole", *value));
  return static_cast<std::int64_t>(*value);
}

std::optional<bool> TomlTable::flag(std::string_view key) const {
  const auto* node = table_->get(key);
  if (node == nullptr) return std::nullopt;
  if (!node->is_boolean()) fail(key, fmt::format("expected true or false, not {}", kind_name(*node)));
  return node->as_boolean()->get();
}

std::optional<std::string> TomlTable::text(std::string_view key) const {
  const auto* node = table_->get(key);
  if (node == nullptr) return std::nullopt;
  if (!node->is_string()) fail(key, fmt::format("expected text in quotes, not {}", kind_name(*node)));
  return node->as_string()->get();
}

std::optional<std::vector<double>> TomlTable::numbers(std::string_view key) const {
  const auto* node = table_->get(key);
  if (node == nullptr) return std::nullopt;
  if (!node->is_array()) fail(key, fmt::format("expected numbers in brackets, not {}", kind_name(*node)));
  std::vector<double> values;
  for (const auto& element : *node->as_array()) {
    const auto value = element.is_number() ? element.value<double>() : std::nullopt;
    if (!value || !std::isfinite(*value)) fail(key, "expected finite numbers only");
    values.push_back(*value);
  }
  return values;
}

std::optional<TomlTable> TomlTable::table(std::string_view key) const {
  const auto* node = table_->get(key);
  if (node == nullptr) return std::nullopt;
  const auto path = path_.empty() ? std::string(key) : path_ + "." + std::string(key);
  if (!node->is_table()) fail(key, fmt::format("expected a table [{}], not {}", path, kind_name(*node)));
  return TomlTable(*node->as_table(), file_, path);
}

std::vector<TomlTable> TomlTable::tables(std::string_view key) const {
  std::vector<TomlTable> tables;
  const auto* node = table_->get(key);
  if (node == nullptr) return tables;
  const auto path = path_.empty() ? std::string(key) : path_ + "." + std::string(key);
  if (!node->is_array()) fail(key, fmt::format("expected [[{}]] in double brackets, not {}", path, kind_name(*node)));
  for (const auto& element : *node->as_array()) {
    if (!element.is_table()) fail(key, fmt::format("expected tables [[{}]], not {}", path, kind_name(element)));
    tables.emplace_back(*element.as_table(), file_, path);
  }
  return tables;
}

double TomlTable::required_number(std::string_view key) const {
  const auto value = number(key);
  if (!value) fail(fmt::format("lacks {}", key));
  return *value;
}

std::string TomlTable::required_text(std::string_view key) const {
  auto value = text(key);
  if (!value) fail(fmt::format("lacks {}", key));
  return *value;
}

}  // namespace handloop::io
