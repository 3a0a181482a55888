#include "tests/support/paths.h"

namespace handloop::test {

const char* source_directory() {
  return HANDLOOP_PATH_OF_SOURCE;
}
const char* program() {
  return HANDLOOP_PATH_OF_PROGRAM;
}

}  // namespace handloop::test
