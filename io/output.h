#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

/// Outputs appear whole or not at all: everything is first written under a hidden name beside its target and renamed
/// into place when it is complete. Not real-time safe; not thread-safe.
namespace handloop::io {

/// Writes the bytes to the path, replacing what was there in one step. "-" writes to standard output.
/// Throws InputError naming the path and the reason where that is not possible.
void write_file_atomically(const std::filesystem::path& path, std::string_view bytes);

/// A file that is written piece by piece and appears at its path with commit(). Without commit() nothing appears.
/// Throws InputError naming the path and the reason where it cannot be made or written.
class OutputFile {
 public:
  explicit OutputFile(std::filesystem::path path);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  const std::filesystem::path& path() const { return path_; }
  void write(std::string_view bytes);
  void commit();

 private:
  std::filesystem::path path_;
  std::filesystem::path staged_;  ///< empty where the target is a device (/dev/stdout), which is written directly
  int descriptor_ = -1;
  std::string buffer_;

  void flush();
};

/// A directory that fills out of sight and appears with commit().
///
/// Write the files under staging(). commit() then
/// - renames the whole into place where the target does not exist or is empty,
/// - exchanges the two in one step where the target holds only what an earlier commit() put there (files of the old run
///   that the new one does not make disappear),
/// - otherwise moves the files in one by one and leaves every other file of the target alone.
/// What was committed is listed in a file `.handloop` of the directory. Without commit() nothing appears, missing
/// parents included.
class OutputDirectory {
 public:
  /// Makes the staging directory, so that a target which cannot be written is found out before the work begins.
  /// Throws InputError naming the path and the reason.
  explicit OutputDirectory(std::filesystem::path target);
  ~OutputDirectory();
  OutputDirectory(const OutputDirectory&) = delete;
  OutputDirectory& operator=(const OutputDirectory&) = delete;

  const std::filesystem::path& target() const { return target_; }
  const std::filesystem::path& staging() const { return staging_; }
  /// Path of a file under staging().
  std::filesystem::path operator/(const std::filesystem::path& name) const { return staging_ / name; }
  void commit();

 private:
  std::filesystem::path target_;
  std::filesystem::path staging_;
  std::vector<std::filesystem::path> made_parents_;  ///< outermost first
};

}  // namespace handloop::io
