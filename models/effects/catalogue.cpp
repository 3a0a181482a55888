#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "models/effects/effect.h"
#include "models/errors.h"
#include "models/suggest.h"

namespace handloop::models {

// One function for each effect file of this folder, written by models/CMakeLists.txt from the file names.
#define HANDLOOP_EFFECT(name) EffectType name##_effect();
#include "effect_list.inc"
#undef HANDLOOP_EFFECT

std::span<const EffectType> effect_catalogue() {
  static const std::array entries{
#define HANDLOOP_EFFECT(name) name##_effect(),
#include "effect_list.inc"
#undef HANDLOOP_EFFECT
  };
  return entries;
}

const EffectType& find_effect_type(std::string_view name) {
  std::vector<std::string_view> names;
  for (const auto& type : effect_catalogue()) {
    if (type.info.name == name) return type;
    names.push_back(type.info.name);
  }
  throw InputError("unknown effect '" + std::string(name) + "'" + suggestion(name, names));
}

EffectPtr make_effect(std::string_view name, Place place, std::span<const double> values) {
  const auto& type = find_effect_type(name);
  const auto& info = type.info;
  if (std::find(info.places.begin(), info.places.end(), place) == info.places.end()) {
    std::string places;
    for (const Place possible : info.places) places.append(places.empty() ? "" : ", ").append(place_name(possible));
    throw InputError(std::string(name) + " cannot act on '" + std::string(place_name(place)) + "': it acts on " +
                     places);
  }
  if (values.size() != info.parameters.size()) {
    throw InputError(std::string(name) + " takes " + std::to_string(info.parameters.size()) + " parameters, not " +
                     std::to_string(values.size()));
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto& parameter = info.parameters[i];
    if (!(values[i] >= parameter.lower && values[i] <= parameter.upper)) {
      char text[200];
      std::snprintf(text, sizeof text, "%s: %s = %g is not possible: it lies between %g and %g",
                    std::string(name).c_str(), std::string(parameter.name).c_str(), values[i], parameter.lower,
                    parameter.upper);
      throw InputError(text);
    }
  }
  return type.make(place, values);
}

EffectPtr make_typical_effect(std::string_view name, Place place) {
  std::vector<double> values;
  for (const auto& parameter : find_effect_type(name).info.parameters) values.push_back(parameter.typical);
  return make_effect(name, place, values);
}

}  // namespace handloop::models
