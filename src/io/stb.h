// The subset of stb that is used: decoding of PNG, JPEG, TGA and BMP from memory.
#pragma once

#define STBI_ONLY_PNG
#define STBI_ONLY_JPEG
#define STBI_ONLY_TGA
#define STBI_ONLY_BMP
#define STBI_NO_STDIO
#define STBI_NO_LINEAR
#define STBI_NO_HDR
#define STBI_NO_SIMD             // the same texels on every machine
#define STBI_NO_FAILURE_STRINGS  // one of them is put together in memory that all threads share
#define STBI_MAX_DIMENSIONS 16384
#include <stb_image.h>

#include <cstddef>

namespace vitral {

// While it lives, a single block that stb asks for on this thread may have at most `bytes`. A file
// can claim to unpack to a thousand times its size; stb itself would follow it.
class StbAllocationLimit {
 public:
  explicit StbAllocationLimit(size_t bytes);
  ~StbAllocationLimit();
  StbAllocationLimit(const StbAllocationLimit&) = delete;
  StbAllocationLimit& operator=(const StbAllocationLimit&) = delete;
};

}  // namespace vitral
