#include "io/effect_tables.h"

#include <fmt/format.h>

#include <vector>

#include "models/errors.h"
#include "models/suggest.h"

namespace handloop::io {
namespace {

const models::EffectType& find_type(const TomlTable& table) {
  const auto name = table.required_text("name");
  for (const auto& type : models::effect_catalogue()) {
    if (type.info.name == name) return type;
  }
  std::vector<std::string_view> known;
  for (const auto& type : models::effect_catalogue()) known.push_back(type.info.name);
  table.fail("name", fmt::format("unknown effect '{}'{}", name, suggestion(name, known)));
}

models::Place read_place(const TomlTable& table, const models::EffectInfo& info) {
  const auto text = table.text("acts_on");
  if (!text) return info.places.front();
  for (const auto place : info.places) {
    if (*text == models::place_name(place)) return place;
  }
  std::string places;
  for (const auto place : info.places)
    places += fmt::format("{}{}", places.empty() ? "" : ", ", models::place_name(place));
  table.fail("acts_on", fmt::format("'{}' is not a place for {}; give {}", *text, info.name, places));
}

}  // namespace

models::EffectPtr read_effect(const TomlTable& table, std::initializer_list<std::string_view> more_keys) {
  std::vector<std::string_view> keys{"name", "acts_on", "parameters"};
  keys.insert(keys.end(), more_keys.begin(), more_keys.end());
  table.allow_only(keys);
  const auto& info = find_type(table).info;
  const auto place = read_place(table, info);

  const auto parameters = table.table("parameters");
  if (parameters) {
    std::vector<std::string_view> known;
    for (const auto& parameter : info.parameters) known.push_back(parameter.name);
    parameters->allow_only(known);
  }
  std::vector<double> values;
  for (const auto& parameter : info.parameters) {
    const auto value = parameters ? parameters->number(parameter.name) : std::nullopt;
    if (!value) {
      values.push_back(parameter.typical);
      continue;
    }
    if (*value < parameter.lower || *value > parameter.upper) {
      parameters->fail(parameter.name, fmt::format("{:g} is out of range; give {:g} to {:g} {}", *value,
                                                   parameter.lower, parameter.upper, parameter.unit));
    }
    values.push_back(*value);
  }
  try {
    return models::make_effect(info.name, place, values);
  } catch (const InputError& error) {
    table.fail(error.what());
  }
}

std::string effect_to_toml(const models::Effect& effect, std::string_view table_name, std::string_view more_lines) {
  auto text = fmt::format("[[{}]]\nname = {}\nacts_on = {}\n{}", table_name, toml_text(effect.info().name),
                          toml_text(models::place_name(effect.place())), more_lines);
  if (!effect.info().parameters.empty()) text += fmt::format("[{}.parameters]\n", table_name);
  for (std::size_t i = 0; i < effect.info().parameters.size(); ++i) {
    text += fmt::format("{} = {}\n", effect.info().parameters[i].name, toml_number(effect.parameters()[i]));
  }
  return text;
}

}  // namespace handloop::io
