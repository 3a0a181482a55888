#include "io/scenario_file.h"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <optional>
#include <type_traits>

#include "io/mapped_file.h"
#include "io/scenario_arm.h"
#include "io/scenario_schema.h"
#include "io/toml_table.h"
#include "models/arm_tables.h"
#include "models/errors.h"
#include "models/suggest.h"

namespace handloop::io {
namespace {

using detail::Range;
using models::Scenario;

std::string describe(const Range& range) {
  if (std::isinf(range.high)) return fmt::format("{} {:g}", range.above ? "above" : "from", range.low);
  return fmt::format("{} {:g} {} {:g}", range.above ? "above" : "from", range.low, range.above ? "up to" : "to",
                     range.high);
}

template <typename Words>
std::string describe_words(const Words& words) {
  std::string list;
  for (const auto& [word, value] : words) list += fmt::format("{}{}", list.empty() ? "" : ", ", word);
  return list;
}

template <typename Words, typename Enum>
std::string_view word_of(const Words& words, Enum value) {
  for (const auto& [word, candidate] : words) {
    if (candidate == value) return word;
  }
  return words.begin()->first;
}

/// Lists the keys, with the value each has in the scenario it walks.
class Lister {
 public:
  std::vector<ScenarioKey> keys;
  std::vector<std::pair<std::string, std::string>> tables;  ///< name and meaning

  void table(std::string_view name, std::string_view meaning) { tables.emplace_back(name, meaning); }
  void text(std::string_view key, const std::string& value, std::string_view meaning) {
    add(key, toml_text(value), "text", meaning);
  }
  void flag(std::string_view key, bool value, std::string_view meaning) {
    add(key, value ? "true" : "false", "true, false", meaning);
  }
  void number(std::string_view key, double value, const Range& range, std::string_view meaning) {
    add(key, toml_number(value), describe(range), meaning);
  }
  template <typename Integer>
  void integer(std::string_view key, Integer value, const Range& range, std::string_view meaning) {
    add(key, fmt::format("{}", value), describe(range), meaning);
  }
  template <std::size_t N>
  void numbers(std::string_view key, const std::array<double, N>& values, const Range& range,
               std::string_view meaning) {
    std::string list;
    for (const double value : values) list += (list.empty() ? "" : ", ") + toml_number(value);
    add(key, "[" + list + "]", fmt::format("{} numbers {}", N, describe(range)), meaning);
  }
  template <typename Enum, typename Words>
  void choice(std::string_view key, Enum value, const Words& words, std::string_view meaning) {
    add(key, toml_text(word_of(words, value)), describe_words(words), meaning);
  }

 private:
  void add(std::string_view key, std::string value, std::string values, std::string_view meaning) {
    keys.push_back({tables.back().first, std::string(key), std::move(value), std::move(values), std::string(meaning)});
  }
};

/// Takes the value of every key that the file has.
class Reader {
 public:
  explicit Reader(const TomlTable& file) : file_(&file) {}

  void table(std::string_view name, std::string_view) {
    current_ = name.empty() ? std::optional(*file_) : file_->table(name);
  }
  void text(std::string_view key, std::string& field, std::string_view) {
    if (auto value = current_ ? current_->text(key) : std::nullopt) field = *value;
  }
  void flag(std::string_view key, bool& field, std::string_view) {
    if (const auto value = current_ ? current_->flag(key) : std::nullopt) field = *value;
  }
  void number(std::string_view key, double& field, const Range& range, std::string_view) {
    const auto value = current_ ? current_->number(key) : std::nullopt;
    if (!value) return;
    check(key, *value, range);
    field = *value;
  }
  template <typename Integer>
  void integer(std::string_view key, Integer& field, const Range& range, std::string_view) {
    const auto value = current_ ? current_->integer(key) : std::nullopt;
    if (!value) return;
    check(key, static_cast<double>(*value), range);
    field = static_cast<Integer>(*value);
  }
  template <std::size_t N>
  void numbers(std::string_view key, std::array<double, N>& field, const Range& range, std::string_view) {
    const auto values = current_ ? current_->numbers(key) : std::nullopt;
    if (!values) return;
    if (values->size() != N) current_->fail(key, fmt::format("has {} numbers, but takes {}", values->size(), N));
    for (std::size_t i = 0; i < N; ++i) {
      check(key, (*values)[i], range);
      field[i] = (*values)[i];
    }
  }
  template <typename Enum, typename Words>
  void choice(std::string_view key, Enum& field, const Words& words, std::string_view) {
    const auto given = current_ ? current_->text(key) : std::nullopt;
    if (!given) return;
    std::vector<std::string_view> known;
    for (const auto& [word, value] : words) {
      if (*given == word) {
        field = value;
        return;
      }
      known.push_back(word);
    }
    current_->fail(key, fmt::format("'{}' is unknown{}", *given, suggestion(*given, known)));
  }

 private:
  const TomlTable* file_;
  std::optional<TomlTable> current_;

  void check(std::string_view key, double value, const Range& range) const {
    if (value > range.low && value <= range.high) return;
    if (value == range.low && !range.above) return;
    current_->fail(key, fmt::format("{:g} is out of range; give a number {}", value, describe(range)));
  }
};

/// Keys of the tables that the schema does not list.
const std::map<std::string, std::vector<std::string_view>>& further_keys() {
  static const std::map<std::string, std::vector<std::string_view>> keys{{"arm", {"x", "y", "z", "effect"}}};
  return keys;
}

/// The key without its unit, as a hurried person writes it: "stiffness" of "stiffness_N_per_m".
std::string_view without_unit(std::string_view key) {
  for (const std::string_view unit :
       {"_N_per_m", "_Ns_per_m", "_Nms_per_rad", "_N_per_s", "_m_per_s2", "_m_per_s", "_A_per_V", "_N_per_V", "_kg",
        "_rad", "_Nm", "_Hz", "_V", "_A", "_N", "_J", "_m", "_s"}) {
    if (key.ends_with(unit)) return key.substr(0, key.size() - unit.size());
  }
  return key;
}

/// Refuses keys that nobody knows, pointing to the nearest in the same table or in another.
void refuse_unknown(const TomlTable& file, const std::vector<ScenarioKey>& keys,
                    const std::vector<std::pair<std::string, std::string>>& tables) {
  const auto check = [&](const TomlTable& table, const std::string& name) {
    std::vector<std::string_view> known;
    for (const auto& key : keys) {
      if (key.table == name) known.push_back(key.name);
    }
    if (name.empty()) {
      for (const auto& [other, meaning] : tables) {
        if (!other.empty()) known.push_back(other);
      }
    }
    if (const auto more = further_keys().find(name); more != further_keys().end()) {
      known.insert(known.end(), more->second.begin(), more->second.end());
    }
    const auto first_unknown = table.first_unknown(known);
    if (first_unknown.empty()) return;
    // The same table first, with and without units; then every table.
    std::vector<std::string_view> short_names;
    for (const auto key : known) short_names.push_back(without_unit(key));
    const auto in_table = [&](std::string_view nearest) -> std::string {
      for (const auto key : known) {
        if (key == nearest || without_unit(key) == nearest) return fmt::format("; did you mean '{}'?", key);
      }
      return {};
    };
    auto hint = in_table(nearest_word(first_unknown, known));
    if (hint.empty()) hint = in_table(nearest_word(first_unknown, short_names));
    if (hint.empty()) {
      std::vector<std::string_view> everywhere;
      for (const auto& key : keys) everywhere.push_back(without_unit(key.name));
      auto nearest = nearest_word(first_unknown, everywhere);
      if (nearest.empty()) nearest = nearest_word(without_unit(first_unknown), everywhere);
      for (const auto& key : keys) {
        if (!nearest.empty() && without_unit(key.name) == nearest) {
          hint = fmt::format("; did you mean '{}' in [{}]?", key.name, key.table);
          break;
        }
      }
    }
    table.fail_unknown(first_unknown, hint.empty() ? suggestion(first_unknown, known) : hint);
  };
  check(file, "");
  for (const auto& [name, meaning] : tables) {
    if (name.empty()) continue;
    if (const auto table = file.table(name)) check(*table, name);
  }
}

}  // namespace

Scenario default_scenario() {
  Scenario scenario;
  for (const auto axis : models::kAxes) scenario.arm.axes[static_cast<std::size_t>(axis)] = models::nominal_arm(axis);
  return scenario;
}

Scenario parse_scenario(std::string_view text, const std::string& name, const std::filesystem::path& folder) {
  const auto parsed = parse_toml(text, name);
  const TomlTable file(parsed, name, "");
  auto scenario = default_scenario();
  Lister lister;
  detail::walk_scenario(std::as_const(scenario), lister);
  refuse_unknown(file, lister.keys, lister.tables);
  Reader reader(file);
  detail::walk_scenario(scenario, reader);
  if (const auto arm = file.table("arm")) detail::read_arms(*arm, folder, scenario.arm);
  return scenario;
}

Scenario read_scenario(const std::filesystem::path& path) {
  return parse_scenario(read_file(path), path.string(), path.parent_path());
}

std::string to_toml(const Scenario& scenario) {
  Lister lister;
  detail::walk_scenario(scenario, lister);
  std::string text, table;
  for (const auto& key : lister.keys) {
    if (key.table != table) text += fmt::format("\n[{}]\n", table = key.table);
    text += fmt::format("{} = {}\n", key.name, key.initial);
    const bool last_of_arm = table == "arm" && (&key == &lister.keys.back() || (&key + 1)->table != "arm");
    if (last_of_arm) text += detail::arms_to_toml(scenario.arm);
  }
  return text;
}

std::vector<ScenarioKey> scenario_keys() {
  const auto scenario = default_scenario();
  Lister lister;
  detail::walk_scenario(scenario, lister);
  return lister.keys;
}

std::string scenario_keys_markdown() {
  const auto scenario = default_scenario();
  Lister lister;
  detail::walk_scenario(scenario, lister);
  std::string text;
  for (const auto& [table, meaning] : lister.tables) {
    text += fmt::format("### {}\n\n{}.\n\n| key | default | values | meaning |\n|---|---|---|---|\n",
                        table.empty() ? "Top of the file" : fmt::format("`[{}]`", table), meaning);
    for (const auto& key : lister.keys) {
      if (key.table == table)
        text += fmt::format("| `{}` | `{}` | {} | {} |\n", key.name, key.initial, key.values, key.meaning);
    }
    text += "\n";
  }
  return text;
}

}  // namespace handloop::io
