#pragma once

#include <span>
#include <string>
#include <string_view>

namespace handloop {

/// The known word nearest to the given one (edit distance with transpositions), or "" where none is near enough to be a
/// slip of the fingers.
std::string_view nearest_word(std::string_view word, std::span<const std::string_view> known);

/// "; did you mean 'k1'?" where a near word exists, else "; known are a, b, c".
std::string suggestion(std::string_view word, std::span<const std::string_view> known);

}  // namespace handloop
