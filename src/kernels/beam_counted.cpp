// The text of beam.cpp with counts. A file of its own, so that what the compiler makes of the one without
// does not depend on it.
#define VITRAL_COUNTED
#include "kernels/beam.cpp"
