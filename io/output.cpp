#include "io/output.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <set>
#include <system_error>

#include "models/errors.h"

namespace handloop::io {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kBufferBytes = 1 << 18;
constexpr const char* kManifest = ".handloop";

[[noreturn]] void fail(const fs::path& path, int error) {
  throw InputError(fmt::format("{}: cannot be written: {}", path.string(), std::strerror(error)));
}

[[noreturn]] void fail(const fs::path& path, const std::error_code& error) {
  throw InputError(fmt::format("{}: cannot be written: {}", path.string(), error.message()));
}

/// A hidden name in the same folder (so that renaming never crosses file systems), unique to this process.
fs::path hidden_name(const fs::path& target) {
  static std::atomic<unsigned> counter{0};
  return target.parent_path() / fmt::format(".{}.{}-{}.part", target.filename().string(), ::getpid(), counter++);
}

void write_all(int descriptor, std::string_view bytes, const fs::path& path) {
  while (!bytes.empty()) {
    const auto written = ::write(descriptor, bytes.data(), bytes.size());
    if (written < 0) {
      if (errno == EINTR) continue;
      fail(path, errno);
    }
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
}

/// Files below a directory, relative to it, without the manifest.
std::set<std::string> files_below(const fs::path& directory) {
  std::set<std::string> names;
  for (const auto& entry : fs::recursive_directory_iterator(directory)) {
    if (entry.is_directory()) continue;
    auto name = entry.path().lexically_relative(directory).string();
    if (name != kManifest) names.insert(std::move(name));
  }
  return names;
}

std::set<std::string> read_manifest(const fs::path& directory) {
  std::set<std::string> names;
  std::ifstream file(directory / kManifest);
  for (std::string line; std::getline(file, line);) names.insert(line);
  return names;
}

void write_manifest(const fs::path& directory, const std::set<std::string>& names) {
  std::string text;
  for (const auto& name : names) text += name + "\n";
  write_file_atomically(directory / kManifest, text);
}

/// Swaps two directories in one step; false where the file system cannot.
bool exchange(const fs::path& a, const fs::path& b) {
  return ::renameat2(AT_FDCWD, a.c_str(), AT_FDCWD, b.c_str(), RENAME_EXCHANGE) == 0;
}

}  // namespace

void write_file_atomically(const fs::path& path, std::string_view bytes) {
  if (path == "-") {
    std::fwrite(bytes.data(), 1, bytes.size(), stdout);
    if (std::fflush(stdout) != 0) fail("standard output", errno);
    return;
  }
  OutputFile file(path);
  file.write(bytes);
  file.commit();
}

OutputFile::OutputFile(fs::path path) : path_(std::move(path)) {
  std::error_code ignored;
  if (fs::is_directory(path_, ignored)) {
    throw InputError(fmt::format("{}: is a directory; give the name of a file", path_.string()));
  }
  // A link stays a link: what it points to is replaced. Devices and pipes cannot be renamed onto.
  auto target = path_;
  if (fs::is_symlink(path_, ignored)) target = fs::weakly_canonical(path_, ignored);
  const auto status = fs::status(target, ignored);
  if (fs::exists(status) && !fs::is_regular_file(status)) {
    descriptor_ = ::open(target.c_str(), O_WRONLY | O_CLOEXEC);
  } else {
    if (fs::exists(status) && ::access(target.c_str(), W_OK) != 0) fail(path_, errno);
    staged_ = hidden_name(target);
    descriptor_ = ::open(staged_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor_ < 0) staged_.clear();
  }
  if (descriptor_ < 0) fail(path_, errno);
  buffer_.reserve(kBufferBytes);
}

OutputFile::~OutputFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
  if (!staged_.empty()) ::unlink(staged_.c_str());
}

void OutputFile::write(std::string_view bytes) {
  if (buffer_.size() + bytes.size() > kBufferBytes) flush();
  if (bytes.size() > kBufferBytes) return write_all(descriptor_, bytes, path_);
  buffer_.append(bytes);
}

void OutputFile::flush() {
  write_all(descriptor_, buffer_, path_);
  buffer_.clear();
}

void OutputFile::commit() {
  flush();
  const int closed = ::close(descriptor_);
  descriptor_ = -1;
  if (closed != 0) fail(path_, errno);
  if (staged_.empty()) return;
  std::error_code ignored;
  const auto target = fs::is_symlink(path_, ignored) ? fs::weakly_canonical(path_, ignored) : path_;
  if (::rename(staged_.c_str(), target.c_str()) != 0) fail(path_, errno);
  staged_.clear();
}

OutputDirectory::OutputDirectory(fs::path target) : target_(std::move(target)) {
  if (target_.empty()) throw InputError("the output directory has no name; give one, for example --out results");
  target_ = fs::absolute(target_).lexically_normal();
  if (!target_.has_filename()) target_ = target_.parent_path();  // "results/" is "results"
  std::error_code error;
  if (fs::is_symlink(target_, error)) target_ = fs::weakly_canonical(target_, error);
  const auto status = fs::status(target_, error);
  if (fs::exists(status)) {
    if (!fs::is_directory(status))
      throw InputError(fmt::format("{}: is a file; --out wants a directory", target_.string()));
    if (::access(target_.c_str(), W_OK | X_OK) != 0) fail(target_, errno);
  }
  for (auto parent = target_.parent_path(); !fs::exists(parent, error) && parent.has_relative_path();
       parent = parent.parent_path()) {
    made_parents_.insert(made_parents_.begin(), parent);
  }
  fs::create_directories(target_.parent_path(), error);
  if (error) fail(target_, error);
  // Beside the target; within it where the folder above cannot be written.
  staging_ = hidden_name(target_);
  if (!fs::create_directory(staging_, error)) {
    if (fs::is_directory(target_)) {
      staging_ = target_ / hidden_name(target_).filename();
      fs::create_directory(staging_, error);
    }
    if (error) {
      staging_.clear();
      fail(target_, error);
    }
  }
}

OutputDirectory::~OutputDirectory() {
  std::error_code ignored;
  if (!staging_.empty()) fs::remove_all(staging_, ignored);
  std::reverse(made_parents_.begin(), made_parents_.end());
  for (const auto& parent : made_parents_) fs::remove(parent, ignored);  // only where still empty
}

void OutputDirectory::commit() {
  std::error_code error;
  const auto names = files_below(staging_);
  write_manifest(staging_, names);
  if (!fs::exists(target_) || fs::is_empty(target_)) {
    fs::rename(staging_, target_, error);
    if (!error) {
      staging_.clear();
      return;
    }
  } else {
    // An older result may go as a whole, a person's own files may not.
    const auto ours = read_manifest(target_);
    const auto present = files_below(target_);
    const bool only_ours = std::includes(ours.begin(), ours.end(), present.begin(), present.end());
    if (only_ours && !ours.empty() && exchange(staging_, target_)) return;  // the destructor removes the old one
  }
  error.clear();
  auto all = read_manifest(target_);
  for (const auto& name : names) {
    fs::create_directories((target_ / name).parent_path(), error);
    if (!error) fs::rename(staging_ / name, target_ / name, error);
    if (error) fail(target_ / name, error);
    all.insert(name);
  }
  write_manifest(target_, all);
}

}  // namespace handloop::io
