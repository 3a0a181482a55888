#pragma once

#include "models/effects/effect.h"

namespace handloop::models {

/// The catalogue entry of an effect class that is made from (Place, values).
template <class T>
EffectType effect_entry(const EffectInfo& info) {
  return {info,
          [](Place place, std::span<const double> values) -> EffectPtr { return std::make_shared<T>(place, values); }};
}

}  // namespace handloop::models
