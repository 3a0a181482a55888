#pragma once

#include <toml++/toml.h>

#include <cstdint>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace handloop::io {

/// Parses TOML; a syntax error becomes an InputError "FILE, line 3, column 7: ...".
toml::table parse_toml(std::string_view text, const std::string& name);

/// A number as TOML writes it, always with a dot or an exponent; reads back to the same bits.
std::string toml_number(double value);
/// A basic string in quotes.
std::string toml_text(std::string_view text);

/// One table of a TOML file, read key by key. Every complaint is an InputError naming file, line and key.
/// Refers to the parsed file, which must live as long.
class TomlTable {
 public:
  /// `path` is the table's name for messages, "" for the top of the file.
  TomlTable(const toml::table& table, std::string file, std::string path);

  /// Throws for the first key that is none of these, with the nearest of them.
  void allow_only(std::span<const std::string_view> keys) const;
  void allow_only(std::initializer_list<std::string_view> keys) const {
    allow_only(std::span<const std::string_view>(keys.begin(), keys.size()));
  }

  /// The first key in the file that is none of these, or "".
  std::string_view first_unknown(std::span<const std::string_view> keys) const;
  /// Complains about an unknown key; `hint` follows its name.
  [[noreturn]] void fail_unknown(std::string_view key, std::string_view hint) const;

  bool has(std::string_view key) const { return table_->contains(key); }
  std::vector<std::string_view> keys() const;

  // The value of a key, or nothing where it is absent; throws where it is of another kind or not finite.
  std::optional<double> number(std::string_view key) const;
  std::optional<std::int64_t> integer(std::string_view key) const;
  std::optional<bool> flag(std::string_view key) const;
  std::optional<std::string> text(std::string_view key) const;
  std::optional<std::vector<double>> numbers(std::string_view key) const;
  std::optional<TomlTable> table(std::string_view key) const;
  std::vector<TomlTable> tables(std::string_view key) const;

  double required_number(std::string_view key) const;
  std::string required_text(std::string_view key) const;

  /// Complains about a key's value: "FILE, line 4: [arm] mass_kg: MESSAGE".
  [[noreturn]] void fail(std::string_view key, std::string_view message) const;
  /// Complains about the table as a whole.
  [[noreturn]] void fail(std::string_view message) const;

 private:
  const toml::table* table_;
  std::string file_;
  std::string path_;

  std::string place(const toml::node* node) const;
};

}  // namespace handloop::io
