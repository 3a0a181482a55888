#pragma once

#include <stdexcept>
#include <string>

namespace handloop {

/// Something a person gave is not usable: a file, a key, a value, an option. The message is one line that names the
/// place, what was wrong and what would be right. The program ends with exit code 2.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A requirement was stated and is not met, or a run ended in a fault. The program ends with exit code 1.
class RequirementError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace handloop
