#include "io/mat_file.h"

#include <fmt/format.h>
#include <matio.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <memory>

#include "io/mapped_file.h"
#include "io/mat_elements.h"
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
    // The message is a char* in matio 1.5.23 and a const char* in 1.5.28.
    Mat_LogInitFunc("handloop", [](int, auto*) {});
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

/// Bytes as a file that exists in memory only.
class MemoryFile {
 public:
  explicit MemoryFile(const std::string& bytes) : descriptor_(::memfd_create("handloop.mat", MFD_CLOEXEC)) {
    for (std::size_t done = 0; done < bytes.size();) {
      const auto written = ::write(descriptor_, bytes.data() + done, bytes.size() - done);
      if (written < 0 && errno == EINTR) continue;
      if (written <= 0) throw InputError("not enough memory to read a MATLAB file");
      done += static_cast<std::size_t>(written);
    }
  }
  ~MemoryFile() { ::close(descriptor_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  std::string path() const { return fmt::format("/proc/self/fd/{}", descriptor_); }

 private:
  int descriptor_;
};

}  // namespace

std::vector<MatVector> read_mat_vectors(const std::filesystem::path& path) {
  silence_library();
  const MappedFile original(path);  // says why a file cannot be read
  if (!original.bytes().starts_with("MATLAB 5.0 MAT-file")) {
    throw InputError(fmt::format("{}: is not a MATLAB file of version 5; save with -v6 or -v7", path.string()));
  }
  std::string damaged;
  const MemoryFile sound(detail::sound_vectors_only(original.bytes(), damaged));
  if (!damaged.empty()) {
    throw InputError(fmt::format("{}: is damaged{}; save it again", path.string(),
                                 damaged == "file" ? "" : " at vector " + damaged));
  }
  const MatFile file(Mat_Open(sound.path().c_str(), MAT_ACC_RDONLY));
  if (!file || Mat_GetVersion(file.get()) != MAT_FT_MAT5) {
    throw InputError(fmt::format("{}: is damaged: its header cannot be read; save it again", path.string()));
  }
  std::vector<MatVector> vectors;
  while (const MatVariable variable{Mat_VarReadNextInfo(file.get())}) {
    if (variable->name == nullptr || variable->rank != 2) continue;
    const auto count = std::max(variable->dims[0], variable->dims[1]);
    if (Mat_VarReadDataAll(file.get(), variable.get()) != 0 || variable->data == nullptr ||
        variable->nbytes != count * static_cast<std::size_t>(variable->data_size)) {
      throw InputError(fmt::format("{}: is damaged at vector {}; save it again", path.string(), variable->name));
    }
    vectors.push_back({variable->name, to_doubles(*variable, count)});
  }
  if (vectors.empty()) throw InputError(fmt::format("{}: holds no named vectors of numbers", path.string()));
  return vectors;
}

void write_mat_vectors(const std::filesystem::path& path, const std::vector<MatVector>& vectors) {
  silence_library();
  const MemoryFile memory("");
  {
    const MatFile file(Mat_CreateVer(memory.path().c_str(), "MATLAB 5.0 MAT-file, written by handloop", MAT_FT_MAT5));
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
  write_file_atomically(path, MappedFile(memory.path()).bytes());
}

}  // namespace handloop::io
