#include "io/memory.h"

#include <sys/mman.h>
#include <cstdint>

namespace vitral {

void prefer_large_pages(void* memory, size_t bytes) {
#ifdef MADV_HUGEPAGE
  // Whole large pages only: the rest of the range may belong to others.
  constexpr uintptr_t kLargePage = uintptr_t{2} << 20;
  const auto address = reinterpret_cast<uintptr_t>(memory);
  const uintptr_t first = (address + kLargePage - 1) & ~(kLargePage - 1);
  const uintptr_t last = (address + bytes) & ~(kLargePage - 1);
  if (first < last) ::madvise(reinterpret_cast<void*>(first), last - first, MADV_HUGEPAGE);
#else
  static_cast<void>(memory);
  static_cast<void>(bytes);
#endif
}

}  // namespace vitral
