#include "io/mat_file.h"

#include <fmt/format.h>
#include <matio.h>

#include <algorithm>
#include <array>
#include <memory>

#include "io/mapped_file.h"
#include "io/output.h"
#include "models/errors.h"

namespace handloop::io {
namespace {

struct CloseMat {
  void operator()(mat_t* file) const { Mat_Close(file); }
};
struct FreeVariable {
  void operator()(matvar_t* variable) const { Mat_VarFree(variable); }
};
using MatFile = std::unique_ptr<mat_t, CloseMat>;
using MatVariable = std::unique_ptr<matvar_t, FreeVariable>;

/// The library would print to standard error; what matters is said by the exception.
void silence_library() {
  static const bool silent = [] {
    Mat_LogInitFunc("handloop", [](int, char*) {});
    return true;
  }();
  static_cast<void>(silent);
}

template <typename Number>
std::vector<double> convert(const matvar_t& variable, std::size_t count) {
  const auto* data = static_cast<const Number*>(variable.data);
  std::vector<double> values(count);
  std::transform(data, data + count, values.begin(), [](Number value) { return static_cast<double>(value); });
  return values;
}

std::vector<double> to_doubles(const matvar_t& variable, std::size_t count) {
  switch (variable.class_type) {
    case MAT_C_DOUBLE:
      return convert<double>(variable, count);
    case MAT_C_SINGLE:
      return convert<float>(variable, count);
    case MAT_C_INT8:
      return convert<std::int8_t>(variable, count);
    case MAT_C_UINT8:
      return convert<std::uint8_t>(variable, count);
    case MAT_C_INT16:
      return convert<std::int16_t>(variable, count);
    case MAT_C_UINT16:
      return convert<std::uint16_t>(variable, count);
    case MAT_C_INT32:
      return convert<std::int32_t>(variable, count);
    case MAT_C_UINT32:
      return convert<std::uint32_t>(variable, count);
    case MAT_C_INT64:
      return convert<std::int64_t>(variable, count);
    case MAT_C_UINT64:
      return convert<std::uint64_t>(variable, count);
    default:
      return {};
  }
}

bool is_numeric(const matvar_t& variable) {
  return variable.class_type >= MAT_C_DOUBLE && variable.class_type <= MAT_C_UINT64;
}

}  // namespace

std::vector<MatVector> read_mat_vectors(const std::filesystem::path& path) {
  silence_library();
  std::size_t file_size = 0;
  {
    const MappedFile file(path);  // says why a file cannot be read
    file_size = file.bytes().size();
    if (!file.bytes().starts_with("MATLAB 5.0 MAT-file")) {
      throw InputError(fmt::format("{}: is not a MATLAB file of version 5; save with -v6 or -v7", path.string()));
    }
  }
  const MatFile file(Mat_Open(path.c_str(), MAT_ACC_RDONLY));
  if (!file || Mat_GetVersion(file.get()) != MAT_FT_MAT5) {
    throw InputError(fmt::format("{}: is damaged: its header cannot be read", path.string()));
  }
  std::vector<MatVector> vectors;
  while (const MatVariable variable{Mat_VarReadNextInfo(file.get())}) {
    if (variable->name == nullptr || !is_numeric(*variable) || variable->isComplex != 0) continue;
    if (variable->rank != 2 || std::min(variable->dims[0], variable->dims[1]) != 1) continue;
    const auto count = std::max(variable->dims[0], variable->dims[1]);
    if (count < 2) continue;
    // Deflate cannot shrink by more than about 1032: a larger claim is damage, not data.
    if (count > file_size * 1100)
      throw InputError(fmt::format("{}: is damaged at vector {}", path.string(), variable->name));
    if (Mat_VarReadDataAll(file.get(), variable.get()) != 0 || variable->data == nullptr ||
        variable->nbytes != count * static_cast<std::size_t>(variable->data_size)) {
      throw InputError(fmt::format("{}: is damaged at vector {}", path.string(), variable->name));
    }
    vectors.push_back({variable->name, to_doubles(*variable, count)});
  }
  if (vectors.empty()) throw InputError(fmt::format("{}: holds no named vectors of numbers", path.string()));
  return vectors;
}

void write_mat_vectors(const std::filesystem::path& path, const std::vector<MatVector>& vectors) {
  silence_library();
  const auto staged = path.string() + ".part";
  {
    const MatFile file(Mat_CreateVer(staged.c_str(), "MATLAB 5.0 MAT-file, written by handloop", MAT_FT_MAT5));
    if (!file) throw InputError(fmt::format("{}: cannot be written", path.string()));
    for (const auto& vector : vectors) {
      std::array<std::size_t, 2> dims{vector.values.size(), 1};
      auto values = vector.values;
      const MatVariable variable(Mat_VarCreate(vector.name.c_str(), MAT_C_DOUBLE, MAT_T_DOUBLE, 2, dims.data(),
                                               values.data(), MAT_F_DONT_COPY_DATA));
      if (!variable || Mat_VarWrite(file.get(), variable.get(), MAT_COMPRESSION_NONE) != 0) {
        throw InputError(fmt::format("{}: cannot be written", path.string()));
      }
    }
  }
  std::filesystem::rename(staged, path);
}

}  // namespace handloop::io
