#pragma once

/// Where this checkout and its program are. Every test sees this header without including it. The paths themselves are
/// compiled into one file (paths.cpp), so that all others compile to the same object in any checkout.
namespace handloop::test {

const char* source_directory();
const char* program();

}  // namespace handloop::test

#define HANDLOOP_SOURCE_DIR (::handloop::test::source_directory())
#define HANDLOOP_PROGRAM (::handloop::test::program())
