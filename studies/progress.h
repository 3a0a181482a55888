#pragma once

#include <cstddef>
#include <functional>

namespace handloop::studies {

/// Told how much of a long job is done: (parts done, parts in all). Called from one thread at a time; may be empty.
using Progress = std::function<void(std::size_t done, std::size_t total)>;

}  // namespace handloop::studies
