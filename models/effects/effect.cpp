#include "models/effects/effect.h"

#include "models/errors.h"
#include "models/polynomial.h"

namespace handloop::models {
std::string_view place_name(Place place) {
  switch (place) {
    case Place::arm:
      return "arm";
    case Place::grasp:
      return "grasp";
    case Place::joint:
      return "joint";
    case Place::actuator:
      return "actuator";
    case Place::sensor:
      return "sensor";
  }
  return "arm";
}

Place parse_place(std::string_view text) {
  for (const Place place : {Place::arm, Place::grasp, Place::joint, Place::actuator, Place::sensor}) {
    if (text == place_name(place)) return place;
  }
  throw InputError("acts_on = '" + std::string(text) + "' is unknown: give arm, grasp, joint, actuator or sensor");
}

std::size_t EffectInfo::parameter_index(std::string_view key) const {
  std::size_t index = 0;
  while (index < parameters.size() && parameters[index].name != key) ++index;
  return index;
}

std::complex<double> LinearElement::operator()(std::complex<double> s) const {
  std::complex<double> value = (mass_kg * s + damping_Ns_per_m) * s + stiffness_N_per_m;
  if (!numerator.empty())
    value += std::exp(-s * delay_s) * evaluate_polynomial(numerator, s) / evaluate_polynomial(denominator, s);
  return value;
}

Effect::Effect(const EffectInfo& info, Place place, std::span<const double> values)
    : info_(&info), place_(place), values_(values.begin(), values.end()) {}

double Effect::parameter(std::string_view key) const {
  const auto index = info_->parameter_index(key);
  if (index == values_.size())
    throw InputError(std::string(info_->name) + " has no parameter '" + std::string(key) + "'");
  return values_[index];
}

}  // namespace handloop::models
