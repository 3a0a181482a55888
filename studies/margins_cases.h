#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

#include "control/margins.h"

/// `margins --cases`: a table of loops in, a table of margins out, row by row in the same order (CONTRACT.md).
namespace handloop::studies {

/// Reads a CSV text with the columns id, axis, M, k1, k2, b1, b2, K, B and, where given, m, b, T, delay_samples,
/// cutoff_Hz (defaults of control::Loop), evaluates every row and returns the CSV text of the results. Other columns
/// are ignored. Works in `threads` threads (0: as many as there are cores); the text is the same for any number. Throws
/// InputError naming file, line and column of the first row that is not possible.
std::string margins_of_cases(std::string_view csv, const std::string& file_name, unsigned threads = 0);

/// The same from file to file; the output appears whole or not at all. Returns the number of rows.
std::size_t margins_of_case_file(const std::filesystem::path& input, const std::filesystem::path& output,
                                 unsigned threads = 0);

}  // namespace handloop::studies
