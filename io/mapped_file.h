#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace handloop::io {

/// The bytes of a file, mapped into memory where it is a plain file and read otherwise (pipes). Read only.
class MappedFile {
 public:
  /// Throws InputError naming the path and the reason where the file cannot be read.
  explicit MappedFile(const std::filesystem::path& path);
  ~MappedFile();
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;

  std::string_view bytes() const { return bytes_; }

 private:
  void* address_ = nullptr;
  std::size_t mapped_size_ = 0;
  std::string content_;
  std::string_view bytes_;
};

/// The whole file as text. Throws like MappedFile.
std::string read_file(const std::filesystem::path& path);

}  // namespace handloop::io
