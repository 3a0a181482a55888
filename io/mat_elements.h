#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace handloop::io::detail {

/// The bytes of a MATLAB file of version 5 with nothing in them but its header and those variables that are plain real
/// vectors of numbers (1 x n or n x 1, n > 1, compressed or not) and whose every length fits what is there.
///
/// The library that reads them trusts lengths: a few damaged bytes make it ask for gigabytes. Structures, cells, text
/// and matrices are passed over here, unread. `damaged` receives the name of the first vector that does not fit, or
/// "file".
std::string sound_vectors_only(std::string_view file, std::string& damaged);

}  // namespace handloop::io::detail
