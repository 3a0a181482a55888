#include <array>

#include "models/effects/effect.h"

namespace handloop::models {

std::span<const EffectType> effect_catalogue() { return {}; }

}  // namespace handloop::models
