#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
#include <string>

#include "fuzz/refused.h"
#include "io/mat_file.h"

using namespace handloop;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  // A file that exists in memory only.
  const int file = ::memfd_create("fuzz.mat", 0);
  fuzz::require(file >= 0 && ::write(file, data, size) == static_cast<ssize_t>(size), "a file in memory");
  fuzz::accepted([&] { io::read_mat_vectors("/proc/self/fd/" + std::to_string(file)); });
  ::close(file);
  return 0;
}
