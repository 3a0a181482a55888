#pragma once

#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "models/errors.h"

namespace handloop::fuzz {

/// Runs a parser: it may refuse with an InputError of one line, and nothing else. True where it accepted.
template <typename Parse>
bool accepted(Parse&& parse) {
  try {
    parse();
    return true;
  } catch (const InputError& error) {
    if (std::string_view(error.what()).find('\n') != std::string_view::npos) {
      std::fprintf(stderr, "more than one line: %s\n", error.what());
      std::abort();
    }
    return false;
  }
}

/// Ends the program where something that must hold does not.
inline void require(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "does not hold: %s\n", what);
  std::abort();
}

}  // namespace handloop::fuzz
