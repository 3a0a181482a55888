#include "models/axis.h"

#include <string>

namespace handloop::models {

Axis parse_axis(std::string_view text) {
  if (text == "x" || text == "X") return Axis::x;
  if (text == "y" || text == "Y") return Axis::y;
  if (text == "z" || text == "Z") return Axis::z;
  throw InputError("unknown axis '" + std::string(text) +
                   "': give x (left-right), y (up-down) or z (forward-backward)");
}

}  // namespace handloop::models
