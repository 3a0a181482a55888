#pragma once

#include <vector>

#include "identify/explain/force_view.h"

namespace handloop::identify {

/// Starts by ForceView for every variant but those that change the grasp: the best of every effect, best first. None
/// where forces are predicted or the base is no arm5.
std::vector<ForceStart> force_scan(const Prediction& prediction, const Hypothesis& from,
                                   const std::vector<Variant>& variants);
/// The same for effects whose gains are of different kinds, as a reflex to stretch and one to its rate: the best start
/// with each gain alone, of as many effects as asked for. Mixed, they may lie in another valley than the truth.
std::vector<ForceStart> single_gain_scan(const Prediction& prediction, const Hypothesis& from,
                                         const std::vector<Variant>& variants);

}  // namespace handloop::identify
