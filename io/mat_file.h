#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace handloop::io {

/// A vector of a MATLAB file, as double precision.
struct MatVector {
  std::string name;
  std::vector<double> values;
};

/// Every real numeric vector (1 x n or n x 1, n > 1) of a MATLAB file of version 5. Other variables are passed over.
/// Throws InputError where the file is missing, damaged or of another kind.
std::vector<MatVector> read_mat_vectors(const std::filesystem::path& path);

/// Writes named vectors as columns, uncompressed version 5. Throws InputError where the path cannot be written.
void write_mat_vectors(const std::filesystem::path& path, const std::vector<MatVector>& vectors);

}  // namespace handloop::io
