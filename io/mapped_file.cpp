#include "io/mapped_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "models/errors.h"

namespace handloop::io {
namespace {

[[noreturn]] void fail(const std::filesystem::path& path, const char* reason) {
  throw InputError(fmt::format("{}: cannot be read: {}", path.string(), reason));
}

struct Descriptor {
  int number;
  ~Descriptor() {
    if (number >= 0) ::close(number);
  }
};

}  // namespace

MappedFile::MappedFile(const std::filesystem::path& path) {
  const Descriptor file{::open(path.c_str(), O_RDONLY | O_CLOEXEC)};
  if (file.number < 0) fail(path, std::strerror(errno));
  struct stat status {};
  if (::fstat(file.number, &status) != 0) fail(path, std::strerror(errno));
  if (S_ISDIR(status.st_mode)) fail(path, "it is a directory; give a file");
  if (S_ISREG(status.st_mode) && status.st_size > 0) {
    mapped_size_ = static_cast<std::size_t>(status.st_size);
    // Populated at once: one pass of the kernel costs less than a page fault for every 4 kB.
    address_ = ::mmap(nullptr, mapped_size_, PROT_READ, MAP_PRIVATE | MAP_POPULATE, file.number, 0);
    if (address_ != MAP_FAILED) {
      bytes_ = {static_cast<const char*>(address_), mapped_size_};
      return;
    }
    address_ = nullptr;
  }
  char block[1 << 16];
  for (;;) {
    const auto got = ::read(file.number, block, sizeof block);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) fail(path, std::strerror(errno));
    if (got == 0) break;
    content_.append(block, static_cast<std::size_t>(got));
  }
  bytes_ = content_;
}

MappedFile::~MappedFile() {
  if (address_ != nullptr) ::munmap(address_, mapped_size_);
}

std::string read_file(const std::filesystem::path& path) {
  return std::string(MappedFile(path).bytes());
}

}  // namespace handloop::io
