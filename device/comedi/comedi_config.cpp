#include "device/comedi/comedi_config.h"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <fstream>
#include <iterator>
#include <numbers>
#include <set>

#include "models/errors.h"
#include "models/suggest.h"

namespace handloop::device::comedi {
namespace {

/// One table of the file; what nobody asked for is unknown.
class Table {
 public:
  Table(const toml::table* table, std::string file, std::string name)
      : table_(table), file_(std::move(file)), name_(std::move(name)) {}

  template <typename T>
  void get(std::string_view key, T& value) {
    known_.push_back(key);
    const toml::node* node = find(key);
    if (node == nullptr) return;
    if constexpr (std::is_same_v<T, double>) {
      const auto found = node->value<double>();
      if (!found || !std::isfinite(*found)) fail(*node, key, "a finite number");
      value = *found;
    } else {
      const auto found = node->value_exact<T>();
      if (!found) fail(*node, key, std::is_same_v<T, bool> ? "true or false" : "text in quotes");
      value = *found;
    }
  }
  void get(std::string_view key, int& value) {
    known_.push_back(key);
    const toml::node* node = find(key);
    if (node == nullptr) return;
    const auto found = node->value_exact<std::int64_t>();
    if (!found || *found < -2147483647 || *found > 2147483647) fail(*node, key, "a whole number");
    value = static_cast<int>(*found);
  }
  template <typename T>
  void get(std::string_view key, std::vector<T>& values) {
    known_.push_back(key);
    const toml::node* node = find(key);
    if (node == nullptr) return;
    const toml::array* list = node->as_array();
    if (list == nullptr) fail(*node, key, "a list");
    values = numbers<T>(*list, key);
  }
  template <typename T, std::size_t N>
  void get(std::string_view key, std::array<T, N>& values) {
    std::vector<T> list(values.begin(), values.end());
    get(key, list);
    if (list.size() != N) fail(*find(key), key, fmt::format("a list of {} values", N));
    std::copy(list.begin(), list.end(), values.begin());
  }
  void get(std::string_view key, std::vector<std::vector<double>>& rows) {
    known_.push_back(key);
    const toml::node* node = find(key);
    if (node == nullptr) return;
    const toml::array* list = node->as_array();
    if (list == nullptr) fail(*node, key, "a list of three lists");
    rows.clear();
    for (const auto& row : *list) {
      if (row.as_array() == nullptr) fail(*node, key, "a list of three lists");
      rows.push_back(numbers<double>(*row.as_array(), key));
    }
  }

  void require(bool holds, std::string_view key, std::string_view right) {
    if (holds) return;
    const toml::node* node = find(key);
    if (node != nullptr) fail(*node, key, right);
    throw InputError(fmt::format("{}: {}.{}: must be {}", file_, name_, key, right));
  }

  void refuse_unknown() const {
    if (table_ == nullptr) return;
    for (const auto& [key, node] : *table_) {
      if (std::find(known_.begin(), known_.end(), key.str()) == known_.end()) {
        throw InputError(fmt::format("{}, line {}: unknown key '{}' in [{}]{}", file_, node.source().begin.line,
                                     std::string(key.str()), name_, suggestion(key.str(), known_)));
      }
    }
  }

 private:
  const toml::node* find(std::string_view key) const { return table_ == nullptr ? nullptr : table_->get(key); }
  [[noreturn]] void fail(const toml::node& node, std::string_view key, std::string_view right) const {
    throw InputError(fmt::format("{}, line {}: {}.{}: must be {}", file_, node.source().begin.line, name_, key, right));
  }
  template <typename T>
  std::vector<T> numbers(const toml::array& list, std::string_view key) const {
    std::vector<T> values;
    for (const auto& item : list) {
      if constexpr (std::is_integral_v<T>) {
        const auto found = item.value_exact<std::int64_t>();
        if (!found) fail(list, key, "a list of whole numbers");
        values.push_back(static_cast<T>(*found));
      } else {
        const auto found = item.value<double>();
        if (!found || !std::isfinite(*found)) fail(list, key, "a list of finite numbers");
        values.push_back(*found);
      }
    }
    return values;
  }

  const toml::table* table_;
  std::string file_, name_;
  std::vector<std::string_view> known_;
};

bool signs(const std::array<int, kMaxMotors>& values) {
  return std::all_of(values.begin(), values.end(), [](int sign) { return sign == 1 || sign == -1; });
}

template <typename T>
bool different(const std::vector<T>& values) {
  return std::set<T>(values.begin(), values.end()).size() == values.size() &&
         std::all_of(values.begin(), values.end(), [](T value) { return value >= 0; });
}

void read_encoders(Table table, ComediConfig::Encoders& e) {
  table.get("board", e.board);
  table.get("subdevices", e.subdevices);
  table.get("counts_per_rev", e.counts_per_rev);
  table.get("signs", e.signs);
  table.get("index_pulse", e.index_pulse);
  table.get("filter", e.filter);
  table.refuse_unknown();
  table.require(e.subdevices.size() == kMaxMotors && different(e.subdevices), "subdevices",
                "three different counters, for example [2, 3, 4]");
  table.require(e.counts_per_rev > 0, "counts_per_rev", "positive");
  table.require(signs(e.signs), "signs", "1 or -1 each");
  table.require(e.filter >= 0 && e.filter <= 6, "filter", "0 (off) to 6");
}

/// What a subdevice of converters needs, inputs or outputs.
void read_converters(Table& table, auto& part) {
  table.get("board", part.board);
  table.get("subdevice", part.subdevice);
  table.get("channels", part.channels);
  table.get("range_V", part.range_V);
}

void require_possible(Table& table, const auto& part) {
  table.require(part.subdevice >= 0, "subdevice", "0 or more");
  table.require(part.range_V > 0, "range_V", "positive");
}

void read_motors(Table table, ComediConfig::Motors& m) {
  read_converters(table, m);
  table.get("signs", m.signs);
  table.get("amplifier_A_per_V", m.amplifier_A_per_V);
  table.get("current_limit_A", m.current_limit_A);
  table.get("torque_Nm_per_A", m.torque_Nm_per_A);
  table.get("transmission_ratio", m.transmission_ratio);
  table.refuse_unknown();
  require_possible(table, m);
  table.require(m.channels.size() == kMaxMotors && different(m.channels), "channels", "three different channels");
  table.require(signs(m.signs), "signs", "1 or -1 each");
  table.require(m.amplifier_A_per_V > 0, "amplifier_A_per_V", "positive");
  table.require(m.current_limit_A > 0, "current_limit_A", "positive");
  table.require(m.torque_Nm_per_A > 0, "torque_Nm_per_A", "positive (signs are apart)");
  for (const double ratio : m.transmission_ratio) table.require(ratio > 0, "transmission_ratio", "positive");
}

void read_force(Table table, ComediConfig::Force& f) {
  table.get("present", f.present);
  read_converters(table, f);
  table.get("differential", f.differential);
  table.get("N_per_V", f.N_per_V);
  table.get("gauge_N_per_V", f.gauge_N_per_V);
  table.refuse_unknown();
  if (!f.present) return;
  require_possible(table, f);
  table.require(different(f.channels) && f.channels.size() >= 3 && f.channels.size() <= kMaxAnalogInputs, "channels",
                "three to eight different channels");
  table.require(f.N_per_V.size() == f.channels.size(), "N_per_V", "a list as long as channels");
  if (f.gauge_N_per_V.empty()) return;
  table.require(f.gauge_N_per_V.size() == 3, "gauge_N_per_V", "three rows: force x, y, z");
  for (const auto& row : f.gauge_N_per_V) {
    table.require(!row.empty() && row.size() <= f.channels.size() && row.size() == f.gauge_N_per_V[0].size(),
                  "gauge_N_per_V", "rows of equal length, not longer than channels");
  }
}

}  // namespace

ComediConfig parse_comedi_config(std::string_view text, const std::string& name) {
  toml::table root;
  try {
    root = toml::parse(text, name);
  } catch (const toml::parse_error& error) {
    throw InputError(fmt::format("{}, line {}: {}", name, error.source().begin.line, error.description()));
  }
  ComediConfig config;
  const auto part = [&](std::string_view key) {
    const toml::node* node = root.get(key);
    if (node != nullptr && node->as_table() == nullptr) {
      throw InputError(fmt::format("{}, line {}: {} must be a table, [{}]", name, node->source().begin.line, key, key));
    }
    return Table(node == nullptr ? nullptr : node->as_table(), name, std::string(key));
  };
  read_encoders(part("encoders"), config.encoders);
  read_motors(part("motors"), config.motors);
  read_force(part("force"), config.force);
  Table guardian = part("guardian");
  guardian.get("watchdog_s", config.watchdog_s);
  guardian.refuse_unknown();
  guardian.require(config.watchdog_s >= 0.002 && config.watchdog_s <= 1.0, "watchdog_s", "from 0.002 to 1");
  constexpr std::array<std::string_view, 4> kTables{"encoders", "motors", "force", "guardian"};
  for (const auto& [key, node] : root) {
    if (std::find(kTables.begin(), kTables.end(), key.str()) == kTables.end()) {
      throw InputError(fmt::format("{}, line {}: unknown key '{}'{}", name, node.source().begin.line,
                                   std::string(key.str()), suggestion(key.str(), kTables)));
    }
  }
  return config;
}

ComediConfig read_comedi_config(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw InputError(path.string() + ": cannot be read; docs/hardware.md shows what belongs in it");
  return parse_comedi_config(std::string{std::istreambuf_iterator<char>(file), {}}, path.string());
}

DeviceDescription describe(const ComediConfig& config, const std::array<double, 3>& pose_rad, double sample_time_s,
                           unsigned dac_maxdata, unsigned adc_maxdata) {
  DeviceDescription d;
  d.sample_time_s = sample_time_s;
  for (std::size_t i = 0; i < kMaxMotors; ++i) {
    d.encoder_rad_per_count[i] = config.encoders.signs[i] * 2.0 * std::numbers::pi / config.encoders.counts_per_rev;
    d.encoder_zero_rad[i] = pose_rad[i];
    d.transmission_ratio[i] = config.motors.transmission_ratio[i];
    d.torque_Nm_per_A[i] = config.motors.signs[i] * config.motors.torque_Nm_per_A;
  }
  d.amplifier_A_per_V = config.motors.amplifier_A_per_V;
  d.current_limit_A = config.motors.current_limit_A;
  d.dac_bits = static_cast<int>(std::bit_width(dac_maxdata));
  d.dac_range_V = config.motors.range_V;
  d.adc_bits = static_cast<int>(std::bit_width(adc_maxdata));
  d.adc_range_V = config.force.range_V;
  d.analog_input_count = config.force.present ? config.force.channels.size() : 0;
  for (std::size_t i = 0; i < d.analog_input_count; ++i) d.analog_N_per_V[i] = config.force.N_per_V[i];
  if (config.force.present && !config.force.gauge_N_per_V.empty()) {
    d.gauge_count = config.force.gauge_N_per_V[0].size();
    for (std::size_t axis = 0; axis < 3; ++axis) {
      std::copy(config.force.gauge_N_per_V[axis].begin(), config.force.gauge_N_per_V[axis].end(),
                d.gauge_N_per_V[axis].begin());
    }
  }
  return d;
}

}  // namespace handloop::device::comedi
