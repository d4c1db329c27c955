// The one translation unit that holds stb_image. Memory comes zeroed, so that what a broken file
// leaves unwritten is the same in every run.
#include <cstddef>
#include <cstdlib>
#include <cstring>

namespace vitral {
namespace {

// stb hands its allocator no context, so the limit of a decoding thread has to live here.
thread_local size_t allocation_limit = 0;

void* stb_allocate(size_t bytes) {
  return bytes <= allocation_limit ? std::calloc(1, bytes) : nullptr;
}

void* stb_reallocate(void* old, size_t old_bytes, size_t bytes) {
  if (bytes > allocation_limit) return nullptr;
  void* const grown = std::realloc(old, bytes);
  if (grown != nullptr && bytes > old_bytes) {
    std::memset(static_cast<char*>(grown) + old_bytes, 0, bytes - old_bytes);
  }
  return grown;
}

}  // namespace
}  // namespace vitral

#define STBI_MALLOC(bytes) vitral::stb_allocate(bytes)
#define STBI_REALLOC_SIZED(old, old_bytes, bytes) vitral::stb_reallocate(old, old_bytes, bytes)
#define STBI_FREE(block) std::free(block)
#define STBI_ASSERT(condition) static_cast<void>(0)
#define STB_IMAGE_IMPLEMENTATION

// In broken files its integer arithmetic leaves the range of int. Whatever comes out is a picture as
// good as any: the numbers wrap around, and the sanitizers need not tell.
#if defined(__clang__)
#pragma clang attribute push(__attribute__((no_sanitize("signed-integer-overflow", "shift"))), \
                             apply_to = function)
#elif defined(__GNUC__)
#pragma GCC push_options
#pragma GCC optimize("wrapv")
#endif

#include "io/stb.h"

#if defined(__clang__)
#pragma clang attribute pop
#elif defined(__GNUC__)
#pragma GCC pop_options
#endif

namespace vitral {

StbAllocationLimit::StbAllocationLimit(size_t bytes) {
  allocation_limit = bytes;
}
StbAllocationLimit::~StbAllocationLimit() {
  allocation_limit = 0;
}

}  // namespace vitral
