#pragma once

#include <string>
#include <vector>

namespace handloop::device::comedi {

/// A Comedi board this machine has, or why it cannot be used.
struct BoardInfo {
  std::string path;
  std::string name;                                         ///< "" where it cannot be opened
  std::string problem;                                      ///< "" where it can
  int counters = 0, analog_inputs = 0, analog_outputs = 0;  ///< channels; counters are subdevices
};

/// Every /dev/comedi0 to 15 there is.
std::vector<BoardInfo> list_boards();

}  // namespace handloop::device::comedi
