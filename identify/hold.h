#pragma once

#include <string_view>

namespace handloop::identify {

/// What the force does between two samples of the recording, as the arm felt it.
enum class Hold {
  continuous,  ///< smooth: a band-limited signal that was merely sampled
  zero_order,  ///< constant until the next sample: a command through a DAC straight onto the hand
  first_order  ///< straight lines between samples
};

std::string_view hold_name(Hold hold);

}  // namespace handloop::identify
