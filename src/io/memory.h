// Large arrays.
#pragma once
#include <cstddef>
#include <vector>

namespace vitral {

// Asks the system to back fresh memory with large pages. Touching memory for the first time costs
// more than all that is then done with it, unless it comes in pieces larger than 4 KiB. Only advice:
// nothing depends on it.
void prefer_large_pages(void* memory, size_t bytes);

// Room for `count` elements in an empty vector.
template <class T>
void reserve_large(std::vector<T>& vector, size_t count) {
  vector.reserve(count);
  prefer_large_pages(vector.data(), vector.capacity() * sizeof(T));
}

template <class T>
void resize_large(std::vector<T>& vector, size_t count, const T& value = T{}) {
  reserve_large(vector, count);
  vector.resize(count, value);
}

}  // namespace vitral
