#pragma once

#include <cstddef>

/// Counts what the calling thread takes from the heap. Linked with `handloop_heap_counter`, a test program has its
/// allocator interposed: glibc's malloc family, so that libraries count too; under a sanitizer, which brings its own,
/// operator new alone.
namespace handloop::test {

/// Allocations of this thread so far.
std::size_t heap_allocations();

/// Allocations while `work` runs.
std::size_t heap_allocations_of(auto&& work) {
  const std::size_t before = heap_allocations();
  work();
  return heap_allocations() - before;
}

}  // namespace handloop::test
