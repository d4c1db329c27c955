// The text of objects.cpp with counts. A file of its own, as for trace.cpp.
#define VITRAL_COUNTED
#include "kernels/objects.cpp"
